# SPDX-License-Identifier: Apache-2.0
# Debian 12's LCM 1.3.1 brings no CMake package, and its pkg-config file asks for GLib's. Sets LCM_FOUND,
# gives LCM::LCM, LCM::headers, LCM_GEN_EXECUTABLE, and LCM_JAR (empty without liblcm-java).
# find_package(LCM COMPONENTS headers) asks for the headers alone.
include(FindPackageHandleStandardArgs)
find_path(LCM_INCLUDE_DIR lcm/lcm.h)
find_library(LCM_LIBRARY lcm)
find_program(LCM_GEN_EXECUTABLE lcm-gen)
find_file(LCM_JAR lcm.jar PATHS /usr/share/java /usr/local/share/java)
if(NOT LCM_JAR)
  set(LCM_JAR "")
endif()
set(needed LCM_INCLUDE_DIR)
if(NOT LCM_FIND_COMPONENTS STREQUAL "headers")
  list(PREPEND needed LCM_LIBRARY LCM_GEN_EXECUTABLE)
endif()
find_package_handle_standard_args(LCM REQUIRED_VARS ${needed}
  REASON_FAILURE_MESSAGE "Debian: apt-get install liblcm-dev liblcm-bin")
if(LCM_FOUND AND LCM_LIBRARY AND NOT TARGET LCM::LCM)
  add_library(LCM::LCM UNKNOWN IMPORTED)
  set_target_properties(LCM::LCM PROPERTIES
    IMPORTED_LOCATION ${LCM_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${LCM_INCLUDE_DIR})
endif()
if(LCM_FOUND AND NOT TARGET LCM::headers)  # what lcm-gen's types need
  add_library(LCM::headers INTERFACE IMPORTED)
  set_target_properties(LCM::headers PROPERTIES INTERFACE_INCLUDE_DIRECTORIES ${LCM_INCLUDE_DIR})
endif()
