# SPDX-License-Identifier: Apache-2.0
# TAUEXT_CODE_FLAGS: how programs and plug-ins are compiled, beside the build type's flags. Alignment takes most of the
# luck out of where code happens to lie.
# tauext_add_plugin(target source...): a plug-in for tauext-gate, bin/target.so, with flags that are the same in every
# build type, because two commits can only be compared if their flags are the same. Beside it bin/target.so.code/ holds
# its assembly and how it is linked, of which the gate makes the layouts that it times.
include_guard()
include(CheckCXXSourceRuns)

set(TAUEXT_CODE_FLAGS -falign-functions=64 -falign-loops=64)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND TAUEXT_CODE_FLAGS -falign-jumps=64 -falign-labels=16 -fno-gnu-unique)
endif()

function(tauext_add_plugin target)
  if(NOT DEFINED TAUEXT_ARCH)
    check_cxx_source_runs("int main() { return !__builtin_cpu_supports(\"x86-64-v3\"); }" TAUEXT_HAS_V3)
    if(TAUEXT_HAS_V3)
      set(TAUEXT_ARCH x86-64-v3)
    endif()
  endif()
  set(flags -O3 -DNDEBUG ${TAUEXT_CODE_FLAGS})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # its file holds all kernels: with a limit on what is inlined into a file one's growth would change another's code
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
  # paths of the checkout must not make two equal builds differ; lines are for tauext-gate explain, and change no code
  target_compile_options(${target} PRIVATE ${flags} -g1 -Wno-array-bounds -ffunction-sections -fdata-sections
    -ffile-prefix-map=${CMAKE_SOURCE_DIR}=. -ffile-prefix-map=${CMAKE_BINARY_DIR}/=./)
  target_compile_definitions(${target} PRIVATE TAUEXT_PLUGIN_FLAGS="${text}")
  set_target_properties(${target} PROPERTIES PREFIX "" UNITY_BUILD OFF CXX_VISIBILITY_PRESET hidden
    VISIBILITY_INLINES_HIDDEN ON LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin
    RULE_LAUNCH_COMPILE "sh \"${CMAKE_CURRENT_FUNCTION_LIST_DIR}/tauextCompile.sh\" \"${CMAKE_CXX_COMPILER}\" \"${CMAKE_CXX_COMPILER_ARG1}\""
    RULE_LAUNCH_LINK "\"${CMAKE_COMMAND}\" -P \"${CMAKE_CURRENT_FUNCTION_LIST_DIR}/tauextLink.cmake\" --")
endfunction()
