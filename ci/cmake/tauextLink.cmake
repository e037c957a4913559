# SPDX-License-Identifier: Apache-2.0
# cmake -P tauextLink.cmake -- COMMAND...: links a plug-in by COMMAND, and keeps beside it, in PLUGIN.so.code/, the
# assembly of its objects (0.s, 1.s, ...) and `link`: SHA-256 of the plug-in, the folder to be in, and then COMMAND, an
# argument a line, with @0, @1, ... for the objects and @out for the plug-in.
set(command "")
set(given OFF)
math(EXPR last "${CMAKE_ARGC} - 1")
foreach(i RANGE ${last})
  if(given)
    list(APPEND command "${CMAKE_ARGV${i}}")
  elseif("${CMAKE_ARGV${i}}" STREQUAL "--")
    set(given ON)
  endif()
endforeach()
execute_process(COMMAND ${command} COMMAND_ERROR_IS_FATAL ANY)

list(FIND command -o at)
math(EXPR at "${at} + 1")
list(GET command ${at} plugin)
file(REMOVE_RECURSE ${plugin}.code)
file(MAKE_DIRECTORY ${plugin}.code)
file(SHA256 ${plugin} hash)
set(text "${hash}\n${CMAKE_CURRENT_BINARY_DIR}\n")
set(objects 0)
foreach(argument IN LISTS command)
  string(REGEX REPLACE "\\.o$" ".s" assembly "${argument}")
  if(argument STREQUAL plugin)
    set(argument @out)
  elseif(argument MATCHES "\\.o$" AND EXISTS "${assembly}")
    # without what a debugger alone reads, which is ten times as long
    execute_process(COMMAND awk
      "/^\t\\.(section|text|data|bss)/ { skip = /^\t\\.section\t\\.debug_/ } !skip && !/^(\t\\.(loc|file)[ \t]|\\.L(VL|BI|BB|BE)[0-9]+:$)/" ${assembly}
      OUTPUT_FILE ${plugin}.code/${objects}.s COMMAND_ERROR_IS_FATAL ANY)
    set(argument @${objects})
    math(EXPR objects "${objects} + 1")
  endif()
  string(APPEND text "${argument}\n")
endforeach()
if(objects EQUAL 0)
  message(FATAL_ERROR "${plugin}: tauextCompile.sh left no assembly, which tauext-gate makes layouts of")
endif()
file(WRITE ${plugin}.code/link "${text}")
