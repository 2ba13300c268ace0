#compdef imtet
# zsh completion of imtet: what bash's offers.
local line file
local -a offers keys
for line in "${(@f)$(bash @SHARE@/bash-completion/completions/imtet "${(@Q)words[1,CURRENT-1]}" "${(Q)PREFIX}")}"; do
    case $line in
    *FILE) file=$line ;;
    *=$'\t'*) keys+=("${${line//:/\\:}/$'\t'/:}") ;;
    ?*) offers+=("${${line//:/\\:}/$'\t'/:}") ;;
    esac
done
_describe imtet offers -- keys -S ''
[[ $file == ?*FILE ]] && compset -P ${(b)file%FILE}
[[ -z $file ]] || _files
