#!/bin/sh
# Exit codes and error messages of isotherm-sim's commands: commands.sh PROGRAM SOURCE_DIRECTORY
set -u
simulator=$1 source=$2
# shellcheck source=tests/support/verdict.sh
. "$source/tests/support/verdict.sh"
model=$source/core/data/head.model
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
failures=0 why='something that a command made is not as it should be'

# expect CODE WORDS COMMAND...: the exit code, and words in one line on stderr ("" for none at all)
expect() {
    code=$1 words=$2
    shift 2
    "$simulator" "$@" >"$work/stdout" 2>"$work/said"
    got=$?
    # The progress of a long command is no error message.
    grep -vE '^isotherm-sim: [a-z ]+: ([0-9]+ of [0-9]+|.* so far$|ended after )' "$work/said" >"$work/stderr"
    lines=$(wc -l <"$work/stderr")
    if [ "$got" -ne "$code" ]; then
        why="isotherm-sim $*: exit code $got, not $code; last it said: $(tail -n 1 "$work/said")"
        echo "$why"
    elif [ -n "$words" ] && { [ "$lines" -ne 1 ] || ! grep -qF -- "$words" "$work/stderr"; }; then
        why="isotherm-sim $*: stderr is not one line with '$words'"
        echo "$why:"
        cat "$work/stderr"
    elif [ -z "$words" ] && [ "$lines" -ne 0 ]; then
        why="isotherm-sim $*: complains"
        echo "$why:"
        cat "$work/stderr"
    else
        return
    fi
    failures=$((failures + 1))
}

# Output that cannot be written is a fault for every command.
for words in --help --version 'eval --help' 'generate --help' 'train --help'; do
    # shellcheck disable=SC2086
    "$simulator" $words >/dev/full 2>"$work/said"
    got=$?
    if [ "$got" -ne 4 ] || ! grep -q '^isotherm-sim: standard output: ' "$work/said"; then
        why="isotherm-sim $words >/dev/full: exit code $got, not 4"
        echo "$why"
        failures=$((failures + 1))
    fi
done

expect 0 '' eval --help
expect 0 '' show --help
expect 2 '--corpus and --out are needed' eval
expect 2 "--method: 'eigenfaces' is no NAME,...|all" eval --corpus x --out "$work/out" --method eigenfaces
expect 2 "--landmarks: 'chin' is no NAME,...|all|upper" eval --landmarks chin
expect 2 "--threads: '0' is no N" eval --threads 0
expect 3 'nowhere' eval --corpus "$work/nowhere" --model "$model" --out "$work/out"
expect 3 'nowhere/head.model' eval --corpus "$work" --model "$work/nowhere/head.model" --out "$work/out"
expect 4 'manifest.csv' eval --corpus "$source/sim/stored" --model "$source/sim/stored/manifest.csv" \
    --out "$work/out"

expect 0 '' landmarks --help
expect 2 '--corpus and --out are needed' landmarks --corpus x
expect 2 "--pictures: 'some' is no N" landmarks --pictures some
expect 2 'must be 1 with spectral heat' landmarks --corpus "$source/sim/stored" --model "$model" \
    --out "$work/out" --threads 2 --heat spectral
expect 3 'nowhere' landmarks --corpus "$work/nowhere" --model "$model" --out "$work/out"
expect 4 'manifest.csv' landmarks --corpus "$source/sim/stored" \
    --model "$source/sim/stored/manifest.csv" --out "$work/out"

mkdir "$work/corpus"
ln -s "$source/sim/stored/p01-enrol" "$source/sim/stored/none-photo3" "$work/corpus"
cat >"$work/corpus/manifest.csv" <<'MANIFEST'
recording,first,count,subject,session,role,pose,expression,note
p01-enrol,0,2,p01,e,gallery,,neutral,
none-photo3,0,1,none,p,impostor,,,photo / bent
MANIFEST
expect 0 '' landmarks --corpus "$work/corpus" --model "$model" --out "$work/landmarks" --pictures 1
for result in frames.csv landmarks.csv summary.json 'worst-01-p01-enrol-?.png' \
    first-ok-person-p01-enrol-0.png 'first-*-photo___bent-none-photo3-0.png'; do
    # shellcheck disable=SC2086
    [ -s "$work/landmarks/"$result ] || {
        echo "landmarks wrote no $result"
        failures=$((failures + 1))
    }
done
expect 4 'nowhere/out' landmarks --corpus "$work/corpus" --model "$model" --out "$model/nowhere/out"

face=$source/sim/stored/p01-enrol
expect 2 '--recording and --out are needed' show --frame 0
expect 2 "--what: 'hat' is unknown" show --recording "$face" --out "$work/x.png" --what hat
expect 2 "--frame: 'x' is no N" show --recording "$face" --out "$work/x.png" --frame x
expect 3 'nowhere' show --recording "$work/nowhere" --out "$work/x.png"
expect 1 'no usable face' show --recording "$source/sim/stored/none-nobody1" --model "$model" \
    --out "$work/x.png"
expect 0 '' show --recording "$source/sim/stored/none-nobody1" --model "$model" --what fit \
    --out "$work/fit.png"
expect 4 'nowhere/x.png' show --recording "$face" --model "$model" --what depth \
    --out "$work/nowhere/x.png"
expect 0 '' show --recording "$face" --model "$model" --what all --out "$work/pictures"
for picture in depth fit mesh heat isotherms; do
    [ -s "$work/pictures/$picture.png" ] || {
        echo "show --what all wrote no $picture.png"
        failures=$((failures + 1))
    }
done

expect 0 '' shapes eval --help
expect 2 'Usage: isotherm-sim shapes' shapes
expect 2 '--out is needed' shapes generate
expect 2 "--preset: 'square' is unknown" shapes generate --preset square --out "$work/s"
expect 2 '--corpus and --out are needed' shapes eval --corpus x
expect 2 "--distort: 'rain:1' is no KIND:LEVEL" shapes eval --distort rain:1
expect 3 'nowhere: No such file' shapes eval --corpus "$work/nowhere" --out "$work/s"
expect 3 'nowhere: No such file' shapes tables --corpus "$work/nowhere" --out "$work/s"
expect 0 '' train --help
expect 0 '' train metric --help
expect 2 'Usage: isotherm-sim train head|cohort|metric' train dance
expect 2 "head|cohort|metric [OPTION...]; did you mean 'head'?" train heads
expect 2 "unknown command 'genrate': did you mean 'generate'?" genrate
expect 2 "unknown command 'dance' (see isotherm-sim --help)" dance
expect 2 'isotherm-sim train head: --ict and --out are needed' train head --ict x
expect 2 '--corpora and --out are needed' train metric
expect 3 'nowhere' train head --ict "$work/nowhere" --out "$work/head.model"
expect 0 '' import --help
expect 2 '--database, --from and --out are needed, or --ict and --out' import --database frgc
expect 2 '--ict needs --out, and neither' import --ict "$work" --database frgc --out "$work/imported"
expect 3 'no folder FaceXModel' import --ict "$work" --out "$work/imported"
expect 2 "--database: 'lfw' is unknown" import --database lfw --from "$work" --out "$work/imported"
expect 3 'no file has a name of the database gavab' import --database gavab --from "$work" --out "$work/imported"

expect 0 '' record --help
expect 2 '--sensor, --frames and --out or --oni are needed' record --sensor replay --frames 3
expect 3 "no sensor 'kinect9'" record --sensor kinect9 --frames 1 --out "$work/r"
expect 2 "unknown option 'record'" record --sensor "replay:path=$face" --frames 1 --oni "$work/r.oni"
expect 2 'cannot list its devices' record --list replay
expect 5 'no frame for 100 ms' record --sensor "replay:path=$work/nobody" --frames 1 --out "$work/r" --patience-ms 100
expect 0 '' record --sensor "replay:path=$face,pace=asap" --frames 2 --out "$work/r"
[ "$(grep -c png "$work/r/depth.txt")" -eq 2 ] || {
    echo 'record --frames 2 did not record 2 frames'
    failures=$((failures + 1))
}
# One visit is drawn in one picture.
expect 2 'and --visit with --picture' replay --corpus "$work/corpus" --out "$work/replay" --picture "$work/visit.png"
expect 3 "no visit 'nobody'" replay --corpus "$work/corpus" --out "$work/replay" --visit nobody
expect 0 '' replay --corpus "$work/corpus" --out "$work/replay-photo" --visit none-photo3 --picture "$work/visit.png"
[ -s "$work/visit.png" ] || {
    echo 'replay --picture wrote no picture'
    failures=$((failures + 1))
}
expect 4 'nowhere/visit.png' replay --corpus "$work/corpus" --out "$work/replay-nowhere" --visit none-photo3 \
    --picture "$work/nowhere/visit.png"

# The same visits are judged at all levels.
expect 0 '' levels --help
expect 2 '--corpus or --alike, and --out are needed' levels --out "$work/levels"
expect 2 "--level: 'safe' is no NAME" replay --level safe
expect 3 'nowhere/manifest.csv' levels --corpus "$work/nowhere" --out "$work/levels-nowhere"
expect 0 '' levels --corpus "$work/corpus" --out "$work/levels"
[ "$(grep -c '^[a-z]*,strangers,0,1,0.000000,' "$work/levels/levels.csv")" -eq 3 ] || {
    echo 'levels did not count one visit of a photograph at three levels'
    failures=$((failures + 1))
}
expect 4 'levels: ' levels --corpus "$work/corpus" --out "$work/levels" # it exists
expect 2 "--adapt: 'perhaps' is no no|yes|both" levels --adapt perhaps
expect 0 '' levels --adapt both --corpus "$work/corpus" --out "$work/levels-both"
for file in levels.csv levels-adapted.csv; do
    [ "$(grep -c '^[a-z]*,strangers,0,1,0.000000,' "$work/levels-both/$file")" -eq 3 ] || {
        echo "levels --adapt both did not count one visit of a photograph at three levels in $file"
        failures=$((failures + 1))
    }
done

# A program in a build tree takes the shipped data files from the source tree. Any other program takes the installed ones.
expect 0 '' show --recording "$face" --what isotherms --out "$work/shipped.png"
expect 0 '' landmarks --corpus "$work/corpus" --out "$work/landmarks-shipped"
expect 0 '' eval --corpus "$source/sim/stored" --gallery-frames 1 --probe-frames 1 --out "$work/eval-shipped"
for words in '"cllr"' '"cllr_min"' '"dcf"' '"mode": "none"'; do
    grep -q "$words" "$work/eval-shipped/summary.json" || {
        echo "eval does not write $words to summary.json"
        failures=$((failures + 1))
    }
done
[ -s "$work/eval-shipped/promise.png" ] || {
    echo 'eval draws no promise.png'
    failures=$((failures + 1))
}
expect 0 '' eval --corpus "$source/sim/stored" --gallery-frames 1 --probe-frames 1 --out "$work/eval-explicit" \
    --model "$model" --metric "$source/core/data/face.metric"
cmp "$work/eval-shipped/scores.csv" "$work/eval-explicit/scores.csv" || {
    echo 'eval without --metric does not measure what the appliance does'
    failures=$((failures + 1))
}
mkdir -p "$work/elsewhere/bin"
cp "$simulator" "$work/elsewhere/bin/isotherm-sim"
simulator=$work/elsewhere/bin/isotherm-sim
if ! [ -e /usr/local/share/isotherm/head.model ]; then
    expect 3 '/share/isotherm/head.model: No such file' show --recording "$face" --out "$work/x.png"
fi

[ "$failures" -eq 0 ] || {
    paint bad "$failures failed; the last: $why"
    echo
    exit 1
}
