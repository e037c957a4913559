#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# sh tauextCompile.sh COMPILER COMMAND... -o X.o -c SOURCE: compiles by COMMAND to assembly X.s, which stays for tauextLink.cmake,
# and assembles it by COMPILER. So ccache, which may be in COMMAND, keeps the assembly; what -save-temps leaves it does not
# keep. One instruction is encoded anew where it is found: as valgrind 3.19, which counts, does not know it, vmovq from a
# register above 7 to one below 8.
set -eu
compiler=$1
shift
before=
for argument; do
  shift
  case $before:$argument in
    *:-c) argument=-S ;;
    -o:*.o) object=$argument assembly=${argument%.o}.s argument=$assembly ;;
  esac
  set -- "$@" "$argument"
  before=$argument
done
"$@"
unknown='	vmovq	%xmm([89]|1[0-5]), %xmm[0-7]$'
if grep -qE "$unknown" "$assembly"; then
  sed -i -E "s/$unknown/	{load}&/" "$assembly"
fi
exec "$compiler" -c "$assembly" -o "$object"
