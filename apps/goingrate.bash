# Completion of goingrate for bash. The command itself says which commands, options and words may come next;
# where it says nothing, files are completed.
_goingrate() {
  local words typed kept
  read -ra words <<< "${COMP_LINE:0:COMP_POINT}"
  [[ ${COMP_LINE:0:COMP_POINT} != *[[:blank:]] ]] || words+=("")
  mapfile -t COMPREPLY < <("${words[0]/#\~/$HOME}" --complete "${words[@]:1}" 2> /dev/null)
  # Bash replaces only what stands behind the last '=' of a word.
  typed=${words[-1]} kept=${typed%"${typed##*=}"}
  [[ $COMP_WORDBREAKS != *=* || -z $kept ]] || COMPREPLY=("${COMPREPLY[@]#"$kept"}")
  # NAME= goes on.
  [[ ${COMPREPLY[0]-} != *= ]] || compopt -o nospace 2> /dev/null
}
complete -o bashdefault -o default -F _goingrate goingrate
