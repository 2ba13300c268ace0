# bash completion of imtet, installed by `make install`: asks the program for its commands, options and settings.

# The words that a setting takes, FILE where it takes a file: "(a|b|FILE)" at the end of its description.
_imtet_setting()
{
    "$1" settings | awk -v key="$2" '
        /^\[/ { section = substr($0, 2, length($0) - 2) }
        /^;/  { words = match($0, /\([^ ()]*(\||FILE)[^ ()]*\)$/) ? substr($0, RSTART + 1, RLENGTH - 2) : "" }
        section "." $1 == key { gsub(/\|/, " ", words); print words }'
}

_imtet()
{
    local program=${COMP_WORDS[0]} command=${COMP_WORDS[1]} cur=${COMP_WORDS[COMP_CWORD]} asked=${COMP_WORDS[COMP_CWORD-1]}
    local before=${COMP_WORDS[COMP_CWORD-2]} motions="kobe-like elcentro-like sylmar-like" words= option=
    if [[ $asked$cur == builtin: ]]; then # name=value and builtin:NAME come as three words
        COMPREPLY=($motions)
        return
    fi
    [[ $cur == = ]] && cur=
    [[ $asked == = ]] && asked=$before
    [[ $asked == -* ]] && option=$("$program" help "$command" 2>/dev/null | grep -E -- "^  $asked [^ ]")
    if ((COMP_CWORD == 1)); then
        words="$("$program" --commands) help --help --version"
    elif [[ $command == help ]]; then
        words=$("$program" --commands)
    elif [[ $before$asked == builtin: ]]; then
        words=$motions
    elif [[ $option == *"--set SECTION"* ]]; then
        words=$("$program" settings | awk '/^\[/ { s = substr($0, 2, length($0) - 2) } / = / && !/^;/ { print s "." $1 "=" }')
        compopt -o nospace 2>/dev/null
    elif [[ $option == *"--design FILE"* ]]; then
        words="none FILE"
    elif [[ $option == *"--design ID"* ]]; then
        words=knee
    elif [[ $option == *"= --set "* ]]; then
        words=$(_imtet_setting "$program" "${option##*= --set }")
    elif [[ $option ]]; then
        [[ $option =~ ^\ \ [-a-z]+\ (FILE|DIR|FOLDER)\  ]] && words=FILE
    elif [[ $asked == *.* && $before == --set ]] || [[ $asked == "$before" ]]; then
        words=$(_imtet_setting "$program" "$asked")
    elif [[ $cur == -* ]]; then
        words="$("$program" help "$command" 2>/dev/null | grep -oE -- '^  --[a-z-]+')"
    else
        words=FILE
    fi
    COMPREPLY=($(compgen -W "${words/FILE*/}" -- "$cur"))
    if [[ $words == *FILE* ]]; then
        COMPREPLY+=($(compgen -f -- "$cur"))
        compopt -o filenames 2>/dev/null
    fi
}
complete -F _imtet imtet
