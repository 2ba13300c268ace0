# Completion of imtet for bash, which sources it, and for zsh and fish, which run it with the words of a line, of which the
# last may be empty; installed by `make install`. Commands, options and settings are asked of the program.

# What may stand in the place of the last WORD, a line each, with a tab before what it is; FILE at the end: any file.
_imtet_offers() # PROGRAM WORD...
{
    local program=$1 command=$2 asked=${*: -2:1} cur=${*: -1} before='' option='' key='' words='' word
    if (($# == 2)) || [[ $# == 3 && $command == help ]]; then
        "$program" help | sed -n 's/^  \([a-z]\+\) \+\([][A-Z|.]\+ \+\)\?/\1\t/p'
        (($# == 3)) || printf '%s\n' help --help --version
        return
    fi
    [[ $cur == --*=* ]] && asked=${cur%%=*} before=${cur%%=*}= cur=${cur#*=}
    [[ $asked == -* ]] && option=$("$program" help "$command" 2>/dev/null | grep -E -- "^  $asked [^ ]")
    if [[ $asked == --set && $cur == *=* ]]; then
        key=${cur%%=*} before+=$key=
    elif [[ $option == *"= --set "* ]]; then
        key=${option##*= --set }
    fi
    if [[ $key ]]; then # its words: "(a|b|FILE)" at the end of its description
        words=$("$program" settings | awk -v key="$key" '
            /^\[/ { section = substr($0, 2, length($0) - 2) }
            /^;/  { words = match($0, /\([^ ()]*(\||FILE)[^ ()]*\)$/) ? substr($0, RSTART + 1, RLENGTH - 2) : "" }
            section "." $1 == key { gsub(/\|/, " ", words); print words }')
    elif [[ $option == *"--set SECTION"* ]]; then
        "$program" settings | awk -v before="$before" '
            /^\[/ { section = substr($0, 2, length($0) - 2) }
            /^;/  { help = substr($0, 3) }
            / = / && !/^;/ { print before section "." $1 "=\t" help }'
    elif [[ $option == *"--design FILE"* ]]; then
        words="none FILE"
    elif [[ $option == *"--design ID"* ]]; then # of the run on the line names and ids of its front
        words=knee
        for word in "${@:3}"; do
            [[ -e $word/run.sqlite ]] || continue
            words+=" $("$program" choose "$word" --json 2>/dev/null | sed -n 's/.*"name": "best[ _]\(.*\)",/best_\1/p')"
            words+=" $("$program" export "$word" --csv - 2>/dev/null | sed '1d; s/,.*//')"
        done
    elif [[ $option ]]; then
        [[ $option =~ ^\ \ [-a-z]+\ (FILE|DIR|FOLDER)\  ]] && words=FILE
    elif [[ $cur == -* ]]; then
        "$program" help "$command" 2>/dev/null | sed -n 's/^  \(--[a-z-]\+\)\( [^ ]*\)\? \+/\1\t/p'
    else # a run, beside any file
        words=FILE
        if "$program" help "$command" 2>/dev/null | grep -q '^usage: .*RUN'; then
            for word in "$cur"*/ "$cur"*/*/; do
                [[ -e ${word}run.sqlite && $word != *[[:space:]]* ]] && words+=" ${word%/}"
            done
        fi
    fi
    for word in $words; do echo "$before$word"; done
}

_imtet()
{
    local line=${COMP_LINE:0:COMP_POINT} cur word words
    read -ra words <<<"$line"
    [[ $line == *[[:space:]] ]] && words+=("")
    cur=${words[-1]}
    COMPREPLY=()
    while IFS=$'\t' read -r word _; do
        if [[ $word == *FILE ]]; then
            mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -f -- "${cur#"${word%FILE}"}")
            compopt -o filenames 2>/dev/null
        elif [[ $word == "$cur"* ]]; then # bash replaces what is behind the last = or :
            COMPREPLY+=("${word#"${cur%"${cur##*[=:]}"}"}")
            [[ $word == *= ]] && compopt -o nospace 2>/dev/null
        fi
    done < <(_imtet_offers "${words[@]}")
}

if [[ ${BASH_SOURCE[0]} == "$0" ]]; then
    _imtet_offers "$@"
else
    complete -F _imtet imtet
fi
