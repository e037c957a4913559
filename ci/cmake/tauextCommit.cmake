# SPDX-License-Identifier: Apache-2.0
# cmake -DSOURCE=FOLDER -DTO=FILE -P tauextCommit.cmake: writes FILE, a source with commit() of
# bench/report/provenance.h, which returns the commit of the tree, or "" where there is no git
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
  OUTPUT_VARIABLE commit ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
set(text "#include \"bench/report/provenance.h\"\nconst char* tauext::commit() { return \"${commit}\"; }\n")
if(EXISTS ${TO})
  file(READ ${TO} before)
endif()
if(NOT "${before}" STREQUAL "${text}")
  file(WRITE ${TO} "${text}")
endif()
