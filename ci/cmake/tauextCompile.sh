#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# sh tauextCompile.sh COMPILER WORDS COMMAND... -o X.o -c SOURCE: compiles with COMMAND to the assembly X.s, which stays there
# for tauextLink.cmake, and assembles it with COMPILER WORDS. COMMAND may begin with ccache, which caches this step; it caches
# nothing that is compiled with -save-temps. One instruction is encoded in another way where it occurs, because valgrind 3.19,
# which counts instructions, does not know it: vmovq from a register above 7 to one below 8.
set -eu
compiler=$1 words=$2
shift 2
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
# shellcheck disable=SC2086  # mostly there are none
exec "$compiler" $words -c "$assembly" -o "$object"
