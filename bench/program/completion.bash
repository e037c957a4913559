# SPDX-License-Identifier: Apache-2.0
# Completion of all tauext programs in bash. What can follow comes from the programs themselves: flags from --help, names
# from --list. Installed for each program; in a source tree: source bench/program/completion.bash
_tauext() {
  local program=${COMP_WORDS[0]} word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}
  local first='' names=''
  if [[ $word == *,* ]]; then  # the last of several
    first=${word%,*},
    word=${word##*,}
  fi
  # what tauext-record lists of the robot of this line
  _tauext_listed() {
    local robot=wallmobot3 i
    for ((i = 1; i + 1 < COMP_CWORD; ++i)); do
      [[ ${COMP_WORDS[i]} != --robot ]] || robot=${COMP_WORDS[i + 1]}
    done
    "$(dirname "$(command -v "$program")")/tauext-record" --list --robot "$robot" 2>/dev/null
  }
  case $before in
    --robot) names=$("$(dirname "$(command -v "$program")")/tauext-record" --list 2>/dev/null | sed -n 's/^robot \([a-z0-9]*\)[,:] .*/\1/p') ;;
    --estimator | --detector) names=$(_tauext_listed | sed -n "/^  ${before#--}s /{s/^  ${before#--}s *//;s/,//g;p}") ;;
    --scenario) names=$(_tauext_listed | sed -n '/^  scenario /,/^\( *joint .*\)\?$/{//d;s/^  \([a-z_0-9]*\) .*/\1/p}') ;;
    --format) names='text csv json md latex' ;;
    --degrade) names='light typical hard' ;;
  esac
  if [[ -z $names && $word == -* ]]; then
    names=$("$program" --help 2>/dev/null | sed -n 's/^ *\(-[A-Za-z],\)*\(--[a-z_-]*\).*/\2/p')
  fi
  mapfile -t COMPREPLY < <(compgen -P "$first" -W "$names" -- "$word")
  [[ -n $names ]] || mapfile -t COMPREPLY < <(compgen -f -- "$word")
  unset -f _tauext_listed
}
complete -o filenames -F _tauext tauext-{bench,calibrate,detect,gate,import,live,peers,record,render,replay,report,score,tune}
