# Completion of goingrate for bash: commands, their options, files.
_goingrate() {
  local word=${COMP_WORDS[COMP_CWORD]} command=${COMP_WORDS[1]}
  local commands="simulate rate fit spectrum stability report map chart paper help"
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W "$commands --help --version" -- "$word")
  elif [[ $command == help ]]; then
    mapfile -t COMPREPLY < <(compgen -W "formats scenario noise identifiability" -- "$word")
  elif [[ ${COMP_WORDS[COMP_CWORD - 1]} == --plot && $word == *. ]]; then
    mapfile -t COMPREPLY < <(compgen -W "${word}svg ${word}pdf ${word}png ${word}gp" -- "$word")
  elif [[ $word == -* ]]; then
    local options
    options=$("${COMP_WORDS[0]}" "$command" --help 2> /dev/null | grep -oE -- '--[a-z][a-z0-9-]*')
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  fi
}
complete -o filenames -F _goingrate goingrate
