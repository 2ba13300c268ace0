# fish completion of imtet: what bash's offers.
function __imtet_offers
    set -l current (commandline -ct)
    for line in (bash @SHARE@/bash-completion/completions/imtet (commandline -opc) "$current")
        if set -l before (string match -r '(.*)FILE$' -- $line)[2]
            for file in (__fish_complete_path (string replace -- "$before" '' "$current"))
                echo $before$file
            end
        else
            echo $line
        end
    end
end
complete -c imtet -f -a '(__imtet_offers)'
