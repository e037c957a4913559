# SPDX-License-Identifier: Apache-2.0
# tauext_add_plugin(target source...): a plug-in for tauext-gate, compiled with flags that are the same in every
# build type, because two commits can only be compared if their flags are the same, and because an
# alignment of 64 takes most of the luck out of where code happens to lie.
include_guard(GLOBAL)
include(CheckCXXSourceRuns)

function(tauext_add_plugin target)
  if(NOT DEFINED TAUEXT_ARCH)
    check_cxx_source_runs("int main() { return !__builtin_cpu_supports(\"x86-64-v3\"); }" TAUEXT_HAS_V3)
    if(TAUEXT_HAS_V3)
      set(TAUEXT_ARCH x86-64-v3)
    endif()
  endif()
  # no limit on what is inlined into the whole file, else one kernel's growth would change another's code
  set(flags -O2 -DNDEBUG -falign-functions=64 -falign-loops=64 -fno-gnu-unique)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    list(APPEND flags --param=large-unit-insns=100000000)
  endif()
  if(TAUEXT_ARCH)
    list(PREPEND flags -march=${TAUEXT_ARCH})
  endif()
  # what else reaches the compiler belongs to a count's key, too
  string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
  string(STRIP "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${type}}" before)
  list(JOIN flags " " text)
  string(STRIP "${before} ${text}" text)
  add_library(${target} MODULE ${ARGN})
  target_link_libraries(${target} PRIVATE tauext::estimators)
  # paths of the checkout must not make two equal builds differ
  target_compile_options(${target} PRIVATE ${flags} -Wno-array-bounds
    -ffile-prefix-map=${CMAKE_SOURCE_DIR}=. -ffile-prefix-map=${CMAKE_BINARY_DIR}=.)
  target_compile_definitions(${target} PRIVATE TAUEXT_PLUGIN_FLAGS="${text}")
  set_target_properties(${target} PROPERTIES PREFIX "" UNITY_BUILD OFF CXX_VISIBILITY_PRESET hidden
    VISIBILITY_INLINES_HIDDEN ON LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
endfunction()
