# SPDX-License-Identifier: Apache-2.0
# How every room makes its library and its tests.
include_guard(GLOBAL)

# parsed once for all libraries, with CLI11 for all programs, and with GoogleTest for all tests; sources include what they use all the same
# (not nlohmann/json.hpp: each source would take a second longer)
set(precompiled <array> <algorithm> <cmath> <functional> <map> <memory> <stdexcept> <string> <vector> <Eigen/LU> <fmt/format.h>
                <fmt/ranges.h>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")  # said so that ccache finds it in another folder, too
  set(CMAKE_CXX_COMPILE_OPTIONS_USE_PCH -include-pch <PCH_FILE>)
endif()
function(tauext_precompile target position_independent)
  add_library(${target} OBJECT ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/empty.cc)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ${position_independent} UNITY_BUILD OFF)
  target_link_libraries(${target} PRIVATE tauext_flags tauext_estimators fmt::fmt)
  target_precompile_headers(${target} PRIVATE ${precompiled} ${ARGN})
endfunction()

# tauext_headers(h...): installed below the folder's own path, as they lie there; ci/docs and ci/check_headers look at
# those of the tree
function(tauext_headers)
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  foreach(header IN LISTS ARGN)
    set(below "")
    if(NOT IS_ABSOLUTE ${header})
      cmake_path(GET header PARENT_PATH below)
      set_property(GLOBAL APPEND_STRING PROPERTY TAUEXT_HEADERS "${folder}/${header}\n")
    endif()
    install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/tauext/${folder}/${below})
  endforeach()
endfunction()

# tauext_not_fuzzed(TARGET): what no fuzzer drives is not instrumented for one, which costs a sixth of its time to compile
function(tauext_not_fuzzed target)
  if(CMAKE_CXX_FLAGS MATCHES "fsanitize=fuzzer")
    target_compile_options(${target} PRIVATE -fno-sanitize-coverage=edge,trace-cmp,indirect-calls,inline-8bit-counters,pc-table,stack-depth)
  endif()
endfunction()

# tauext_library(NAME [SOURCES s...] [HEADERS h...] [PUBLIC lib...] [PRIVATE lib...] [OPTIONS o...] [WITH l]): static, as
# tauext_NAME and tauext::NAME; installed and exported with its headers, below the folder's own path, as component NAME.
# WITH l: as a part of component l.
function(tauext_library name)
  cmake_parse_arguments(ARG "" "WITH" "SOURCES;HEADERS;PUBLIC;PRIVATE;OPTIONS" ${ARGN})
  set(target tauext_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(tauext::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:tauext_flags>)
  # g++ 12 takes Eigen's half-register loads for reads beyond the vector
  target_compile_options(${target} PRIVATE -Wno-array-bounds ${ARG_OPTIONS})
  if(fmt::fmt IN_LIST ARG_PRIVATE)
    target_precompile_headers(${target} REUSE_FROM tauext_precompiled)
  endif()
  if(ARG_WITH)
    install(TARGETS ${target} EXPORT tauext-${ARG_WITH})
  else()
    install(TARGETS ${target} EXPORT tauext-${name})
    install(EXPORT tauext-${name} NAMESPACE tauext:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/tauext)
  endif()
  tauext_headers(${ARG_HEADERS})
endfunction()

# tauext_program(NAME SOURCE LIBRARIES lib...): a program of ours in bin/, which links what it uses, and is one of tauext_programs
add_custom_target(tauext_programs)
function(tauext_program name source)
  add_executable(${name} ${source})
  target_link_libraries(${name} PRIVATE ${ARGN} tauext_program tauext_flags tauext_estimators fmt::fmt)
  target_compile_options(${name} PRIVATE -O1)  # as the precompiled headers of programs: what takes time is in libraries
  target_precompile_headers(${name} REUSE_FROM tauext_precompiled_program)
  target_link_options(${name} PRIVATE -Wl,--as-needed)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
  add_dependencies(tauext_programs ${name})
  install(TARGETS ${name} OPTIONAL COMPONENT programs)  # ci/bench does not build them all
endfunction()

# Tests run at the top of the tree. So no path of the checkout is compiled into them, and another checkout gets them from
# ccache.
file(RELATIVE_PATH TAUEXT_BIN_FROM_TOP ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/bin)

# tauext_test(NAME SOURCES s... [RELEASE s...] LIBRARIES lib... [DEFINITIONS d...] [FAST] [PROPERTIES p v...] [LONG f]):
# a GoogleTest program, at -O1 as the precompiled headers of tests are, which takes a fifth less to compile; FAST: as what
# is measured. RELEASE are sources that take minutes without optimisation, or whose numbers no sanitizer has to see; a
# source that is in both lists has tests that mean something else there. LONG
# (a filter of GoogleTest's) are tests that take a minute or more, which ci/test --long runs.
function(tauext_test name)
  cmake_parse_arguments(ARG "FAST" "LONG" "SOURCES;RELEASE;LIBRARIES;DEFINITIONS;PROPERTIES" ${ARGN})
  if(TAUEXT_ONLY_RELEASE_TESTS)
    set(ARG_SOURCES ${ARG_RELEASE})
  elseif(CMAKE_BUILD_TYPE STREQUAL "Release")
    list(APPEND ARG_SOURCES ${ARG_RELEASE})
  endif()
  if(NOT ARG_SOURCES)
    return()
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LIBRARIES} tauext_flags tauext_estimators fmt::fmt GTest::gtest_main)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_options(${name} PRIVATE -Wno-array-bounds $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow>)
  target_compile_options(${name} PRIVATE -fmacro-prefix-map=${PROJECT_SOURCE_DIR}/=)  # the same in any folder
  target_compile_definitions(${name} PRIVATE ${ARG_DEFINITIONS})
  tauext_not_fuzzed(${name})
  if(NOT ARG_FAST)
    target_precompile_headers(${name} REUSE_FROM tauext_precompiled_test)
    target_compile_options(${name} PRIVATE -O1)
  endif()
  # asked when ctest runs, not within 5 s of a busy build; tests with a parameter name it themselves, in a word
  set(how WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 120 NO_PRETTY_VALUES)
  if(ARG_LONG)
    list(TRANSFORM ARG_PROPERTIES REPLACE "^selftest$" selftest-long OUTPUT_VARIABLE properties)
    if(NOT LABELS IN_LIST properties)
      list(APPEND properties LABELS long)
    endif()
    gtest_discover_tests(${name} TEST_FILTER "${ARG_LONG}" ${how} PROPERTIES ${properties})
    set(ARG_LONG "-${ARG_LONG}")
  endif()
  if(ARG_PROPERTIES)
    list(APPEND how PROPERTIES ${ARG_PROPERTIES})
  endif()
  gtest_discover_tests(${name} TEST_FILTER "${ARG_LONG}" ${how})
endfunction()
