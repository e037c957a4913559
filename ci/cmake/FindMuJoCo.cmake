# SPDX-License-Identifier: Apache-2.0
# Debian's mujocoConfig.cmake names the headers of a package that libmujoco-dev does not depend on, and
# MuJoCo's own releases have none, so the library is looked up here: -DMuJoCo_ROOT=FOLDER for a release
# that was unpacked by hand. Sets MuJoCo_FOUND, gives MuJoCo::MuJoCo and its MuJoCo::headers alone.
include(FindPackageHandleStandardArgs)
find_path(MuJoCo_INCLUDE_DIR mujoco/mujoco.h)
find_library(MuJoCo_LIBRARY mujoco)
if(DEFINED MuJoCo_ROOT)
  cmake_path(ABSOLUTE_PATH MuJoCo_ROOT NORMALIZE OUTPUT_VARIABLE _root)
  foreach(_found ${MuJoCo_INCLUDE_DIR} ${MuJoCo_LIBRARY})
    cmake_path(IS_PREFIX _root ${_found} NORMALIZE _within)
    if(NOT _within)
      message(FATAL_ERROR "MuJoCo_ROOT is ${MuJoCo_ROOT}, and ${_found} was found: that folder must have include/mujoco/mujoco.h and lib/libmujoco.so, and a build folder made with another MuJoCo has to be made anew")
    endif()
  endforeach()
endif()
if(MuJoCo_INCLUDE_DIR)
  file(STRINGS ${MuJoCo_INCLUDE_DIR}/mujoco/mujoco.h _line REGEX "#define mjVERSION_HEADER")
  string(REGEX MATCH "[0-9]+" _digits "${_line}")
  if(_digits LESS 1000)  # 222, and from 3.5.0 on 3005000
    string(REGEX REPLACE "(.)(.)(.)$" "\\1.\\2.\\3" MuJoCo_VERSION "${_digits}")
  else()
    math(EXPR _major "${_digits} / 1000000")
    math(EXPR _minor "${_digits} / 1000 % 1000")
    math(EXPR _patch "${_digits} % 1000")
    set(MuJoCo_VERSION ${_major}.${_minor}.${_patch})
  endif()
endif()
find_package_handle_standard_args(MuJoCo REQUIRED_VARS MuJoCo_LIBRARY MuJoCo_INCLUDE_DIR
                                  VERSION_VAR MuJoCo_VERSION)
if(MuJoCo_FOUND AND NOT TARGET MuJoCo::MuJoCo)
  add_library(MuJoCo::headers INTERFACE IMPORTED)
  set_target_properties(MuJoCo::headers PROPERTIES INTERFACE_INCLUDE_DIRECTORIES ${MuJoCo_INCLUDE_DIR})
  add_library(MuJoCo::MuJoCo UNKNOWN IMPORTED)
  set_target_properties(MuJoCo::MuJoCo PROPERTIES
    IMPORTED_LOCATION ${MuJoCo_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${MuJoCo_INCLUDE_DIR})
endif()
