# A simulator for tests of the JSON lines protocol: f = (x1, x2). Every third request it misbehaves as $1 says.
# With $1 waits the 30th request is answered once $3 of them are in the file $2, which must be within $4 tenths of a second.
# With $1 bounded or unbounded whole numbers x1, x2 in 0..20 and a word: 6 <= x1 <= 15 - x2 as g; $2 gets the requests.
[ "$1" = unasked ] && echo "welcome to the simulator"
[ "$1" = deaf ] && { : >"${2:-/dev/null}"; exec sleep 60; }
while read -r line; do
    id=${line#*:}
    id=${id%%,*}
    x=${line#*[}
    x=${x%]*}
    x1=${x%%,*}
    x2=${x#*,}
    x2=${x2%%,*}
    good="{\"id\":$id,\"f\":[$x1,$x2]}"
    [ "$1" = words ] && case $x1 in '"steel"') good="{\"id\":$id,\"f\":[1,$x2]}" ;; '"oak"') good="{\"id\":$id,\"f\":[0,1$x2]}" ;; *) good=no ;; esac
    case $1 in *bounded)
        case $x in *'"b"') more=3 ;; *) more=0 ;; esac
        good="{\"id\":$id,\"f\":[$x1,$((20 - x1 + x2 + more))]"
        [ -n "$2" ] && echo "$id" >>"$2"
        [ "$1" = unbounded ] && [ $((id % 3)) -eq 0 ] && good="$good}" || good="$good,\"g\":[$((6 - x1)),$((x1 + x2 - 15))]}" ;;
    esac
    [ "$1" = steady ] && sleep 0.04
    [ "$1" = waits ] && { echo "$id" >>"$2"; tries=$4
        while [ "$id" -eq 30 ] && [ "$(wc -l <"$2")" -lt "$3" ]; do sleep 0.1; [ $((tries -= 1)) -gt 0 ] || { good='{}'; break; }; done; }
    [ "$1" = uneven ] && if [ $((id % 10)) -eq 0 ]; then sleep 0.1; else sleep 0.005; fi
    [ "$1" = tenth ] && [ $((id % 10)) -eq 0 ] && good="{\"id\":$id,\"error\":\"every tenth\"}"
    [ $((id % 3)) -ne 0 ] && mode=good || mode=$1
    case $mode in
    error) echo "{\"id\":$id,\"error\":\"no, \\\"never\\\" this one\"}" ;;
    formula) echo "{\"id\":$id,\"error\":\"=1+1,=2\"}" ;;
    umlauts) printf '{"id":%s,"error":"a' "$id"; printf 'ä%.0s' $(seq 100); echo '"}' ;;
    latin) printf '{"id":%s,"error":"zu gro\337"}\n' "$id" ;;
    calm) echo "{\"id\":$id,\"error\":null,\"f\":[$x1,$x2]}" ;;
    real) echo "{\"id\":$id.0,\"f\":[$x1,$x2]}" ;;
    overflow) echo "{\"id\":$id,\"f\":[1,-1e999]}" ;;
    largest) echo "{\"note\":-1.7976931348623157e+308,\"id\":$id,\"f\":[$x1,$x2]}" ;;
    blanks) yes '' | head -c 5000000; echo "$good" ;;
    child) sleep 60 & exit 3 ;;
    dies) exit 3 ;;
    killed) kill -9 $$ ;;
    silent) sleep 60 ;;
    garbled) echo "convergence reached" ;;
    huge) head -c 2000000 /dev/zero | tr '\0' a ;;
    flood) yes "iteration" ;;
    nan) echo "{\"id\":$id,\"f\":[1,NaN]}" ;;
    infinity) echo "{\"note\":\"an \\\"inf\\\" is NaN\",\"id\":$id,\"f\":[-Infinity, inf]}" ;;
    null) echo "{\"id\":$id,\"f\":[1,null]}" ;;
    short) echo "{\"id\":$id,\"f\":[1]}" ;;
    nothing) echo "{\"id\":$id}" ;;
    stranger) echo "{\"id\":123456,\"f\":[1,2]}" ;;
    spaced) printf '\n   \n%s\n' "$good" ;;
    slowly) printf '%s' "{\"id\":$id,"; sleep 0.05; echo "\"f\":[$x1,$x2]}" ;;
    *) echo "$good" ;;
    esac
    [ "$1" = once ] && exit 0
done
