# SPDX-License-Identifier: Apache-2.0
# Debian packages of what is installed, by CPack; ci/package makes them.
set(maintainers "The tauext maintainers <maintainers@users.noreply.h-seed-bd7ea0e9.example>")
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME tauext)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/package)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL programs dev python spy)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${maintainers}")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)

# tauext_package(COMPONENT NAME [DEPENDS p...] [RECOMMENDS p...] SAYS line [line...]): besides what its programs link
function(tauext_package component name)
  cmake_parse_arguments(ARG "" "" "DEPENDS;RECOMMENDS;SAYS" ${ARGN})
  string(TOUPPER ${component} C)
  list(JOIN ARG_DEPENDS ", " depends)
  list(JOIN ARG_RECOMMENDS ", " recommends)
  list(JOIN ARG_SAYS "\n" says)
  set(CPACK_DEBIAN_${C}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${C}_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${C}_PACKAGE_RECOMMENDS "${recommends}" PARENT_SCOPE)
  set(CPACK_COMPONENT_${C}_DESCRIPTION "${says}" PARENT_SCOPE)
  install(FILES ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/deb/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component})
  install(FILES ${PROJECT_BINARY_DIR}/changelog.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component} OPTIONAL)
endfunction()
# what no program links, so that dpkg-shlibdeps does not see it: MuJoCo, libmatio and what draws pictures, which are loaded, and the Python that the
# module is for
function(tauext_owner package library)
  file(REAL_PATH ${library} library)
  execute_process(COMMAND dpkg-query -S ${library} OUTPUT_VARIABLE owner ERROR_QUIET)
  string(REGEX MATCH "^[^:]+" owner "${owner}")
  set(${package} ${owner} PARENT_SCOPE)
endfunction()
get_target_property(mujoco MuJoCo::MuJoCo IMPORTED_LOCATION)
tauext_owner(mujoco ${mujoco})
set(matio "")
if(MATIO_LIBRARY)
  tauext_owner(matio ${MATIO_LIBRARY})
endif()
if(TARGET tauext_python)
  execute_process(COMMAND ${Python_EXECUTABLE} -c "import sys; print('python3 (>= 3.%d);python3 (<< 3.%d)' % (sys.version_info[1], sys.version_info[1] + 1))"
                  OUTPUT_VARIABLE python OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
endif()
tauext_package(programs tauext DEPENDS ${mujoco} libgl1-mesa-dri RECOMMENDS bash-completion ${matio} SAYS
  "Estimators of external joint torque of robot arms, compared"
  "Scores and times estimators and collision detectors against the exact truth of"
  "a simulation, replays recordings, tunes, shows estimates live, and gates CI.")
tauext_package(dev libtauext-dev DEPENDS libeigen3-dev
  RECOMMENDS libbenchmark-dev libcli11-dev libfmt-dev libgtest-dev liblcm-dev libmujoco-dev libegl-dev libpng-dev
             libarchive-dev libreaderwriterqueue-dev libsqlite3-dev libtinyxml2-dev nlohmann-json3-dev zlib1g-dev SAYS
  "Estimators of external joint torque as C++ headers, and the suite as libraries"
  "find_package(tauext) gives the estimators, which need Eigen alone, and by"
  "components the suite for estimators of your own, which needs what is recommended.")
tauext_package(python python3-tauext DEPENDS ${python} python3-numpy ${mujoco} RECOMMENDS python3-matplotlib SAYS
  "Estimators of external joint torque of robot arms from Python"
  "import tauext: scenarios as NumPy arrays, estimators and detectors by name,"
  "scores, and estimators of your own in Python.")
tauext_package(spy tauext-spy DEPENDS default-jre liblcm-java libjchart2d-java SAYS
  "lcm-spy with a window for estimates of external joint torque"
  "Shows truth, estimates and marks of a stream or a log of tauext as curves.")
foreach(component PROGRAMS PYTHON)
  set(CPACK_DEBIAN_${component}_PACKAGE_SHLIBDEPS ON)
  if(TAUEXT_ARCH STREQUAL "x86-64-v3")
    set(CPACK_DEBIAN_${component}_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/deb/preinst)
  endif()
endforeach()
list(APPEND CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/deb/prerm)
set(CPACK_DEBIAN_SPY_PACKAGE_ARCHITECTURE all)

install(DIRECTORY ${PROJECT_SOURCE_DIR}/bench/examples/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/tauext/examples COMPONENT programs)
# written by ci/package, as changelog.gz is
install(DIRECTORY ${PROJECT_BINARY_DIR}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT programs OPTIONAL)
install(DIRECTORY ${PROJECT_BINARY_DIR}/completion/ DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT programs OPTIONAL)
include(CPack)
