#!/bin/sh
# The end of the demo's output, on a small corpus: demo_ends.sh BUILD_DIRECTORY SOURCE_DIRECTORY. The last lines are the verdict and
# the path of a picture. Tables are in files. Colours are printed only on terminals, and only if the user wants them.
set -u
build=$1 source=$2
command -v dbus-daemon >/dev/null || exit 77
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
failures=0

fail()
{
    echo "$1"
    failures=$((failures + 1))
}

mkdir "$work/corpus"
for recording in p01-enrol p01-v1 p02-enrol p02-v1 none-photo3; do
    ln -s "$source/sim/stored/$recording" "$work/corpus"
done
cat >"$work/corpus/manifest.csv" <<'MANIFEST'
recording,first,count,subject,session,role,pose,expression,note
p01-enrol,0,5,p01,e,gallery,,neutral,
p02-enrol,0,5,p02,e,gallery,,neutral,
p01-v1,0,3,p01,v,probe,,mild,
p02-v1,0,3,p02,v,probe,,mild,
none-photo3,0,3,none,p,impostor,,,photo
MANIFEST
verdict='2 of 2 enrolled people admitted (at 2 of their 2 visits); 0 under another name; 0 of 1 visits of strangers and non-faces admitted: good'

"$source/sim/demo.sh" "$build" "$work/out" "$work/corpus" >"$work/printed" 2>"$work/errors" || {
    cat "$work/printed" "$work/errors"
    fail 'the demo failed'
}
[ "$(tail -n 2 "$work/printed" | head -n 1)" = "$verdict" ] || fail "the last line but one is no verdict: $(tail -n 2 "$work/printed")"
[ "$(tail -n 1 "$work/printed")" = "a visit: $work/out/visit.png" ] || fail 'the last line names no picture'
[ "$(wc -l <"$work/printed")" -le 9 ] || fail 'tables are printed'
[ "$(head -c 4 "$work/out/visit.png" | tail -c 3)" = PNG ] || fail 'the picture is no PNG'
for table in enrolled.txt list.txt visits.txt visits.csv status.txt eval/report.txt; do
    [ -s "$work/out/$table" ] || fail "there is no $table"
done

# The same on a terminal. A person who is admitted by mistake turns the verdict red. Here the corpus calls p02 a stranger.
sed -i 's/^p02-v1,0,3,p02,v,probe/p02-v1,0,3,x02,v,impostor/' "$work/corpus/manifest.csv"
command="$source/sim/demo.sh $build $work/again $work/corpus"
TERM=xterm NO_COLOR='' script -qec "$command" /dev/null >"$work/printed"
[ $? -eq 1 ] || fail 'a stranger who was let in does not fail the demo'
grep -q "$(printf '\033')\[1;31m.*NOT GOOD" "$work/printed" || fail "a failure is not red: $(tail -n 4 "$work/printed")"
TERM=xterm NO_COLOR=1 script -qec "$command" /dev/null >"$work/printed"
grep -q "$(printf '\033')\[[0-9;]*m" "$work/printed" && fail 'NO_COLOR is not honoured'
[ "$failures" -eq 0 ]
