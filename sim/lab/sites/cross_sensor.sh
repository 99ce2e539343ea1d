#!/bin/sh
# Measures people who are enrolled before one sensor and seen by another: what is lost, and what it gains to enrol them again before the
# second one, which is the row with that sensor twice. The people and visits are those of preset strong, as in promise.sh: every sensor
# sees the same visits. SCRATCH keeps the corpora (sites-strong-SENSOR), which are rendered only if they are missing, and the reports
# (cross-ENROLLED-SEEN). The environment may set PAIRS, words of the form ENROLLED:SEEN.
# usage: cross_sensor.sh ISOTHERM_SIM ICT_DIRECTORY DATA_DIRECTORY SCRATCH
set -eu
sim=$1 ict=$2 data=$3 scratch=$4
here=$(dirname "$0")
export OPENBLAS_NUM_THREADS=1
mkdir -p "$scratch"
scratch=$(cd "$scratch" && pwd) # links need the whole path

# join ENROLLED SEEN: a corpus of links to the enrolments before one sensor and the visits before another
join() {
    corpus=$scratch/cross-$1-$2/corpus
    rm -rf "$scratch/cross-$1-$2"
    mkdir -p "$corpus"
    cp "$scratch/sites-strong-$1/manifest.csv" "$corpus/manifest.csv"
    awk -F , 'NR > 1 { print $1, $6 }' "$corpus/manifest.csv" | while read -r recording role; do
        from=$2
        [ "$role" != gallery ] || from=$1
        ln -s "$scratch/sites-strong-$from/$recording" "$corpus/$recording"
    done
}

# evaluate ENROLLED SEEN SITE: prints the rates as cells of a table
evaluate() {
    out=$scratch/cross-$1-$2
    "$sim" eval --corpus "$out/corpus" --fuse 1 --site "$3" --model "$data/head.model" --metric "$data/face.metric" --out "$out" \
        >"$out/report-$3.txt"
    awk '/^  rank 1 / && !rank { rank = $3 }
         /^  EER / && !eer { eer = $2 " " $4 " " $5 }
         $1 == "3.0" && NF == 6 { lost = $6 }
         /^Promise:/ { promises = 1; next }
         /^  Cllr/ { promises = 0 }
         promises && $1 == 2 && NF == 5 { two = $3 }
         promises && $1 == 3 && NF == 5 { three = sprintf("%.3f [%.3f, %.3f]", $3, substr($4, 2), $5) }
         END { printf " %.1f | %s | %.2f | %s | %.1f |\n", rank, eer, two, three, lost }' "$out/report-$3.txt"
}

echo '| enrolled before | seen by | metric | rank 1, % | EER, % | non-mated that reach 2, % | reach 3, % | mated lost at 3, % |'
echo '| --- | --- | --- | --- | --- | --- | --- | --- |'
for pair in ${PAIRS:-truedepth:truedepth astra:astra kinect2:kinect2 kinect2-coarse:kinect2-coarse truedepth:d435 truedepth:astra \
    truedepth:kinect2 truedepth:kinect2-coarse astra:kinect2 astra:kinect2-coarse}; do
    enrolled=${pair%:*} seen=${pair#*:}
    for sensor in "$enrolled" "$seen"; do
        "$here/render.sh" "$sim" "$ict" strong "$sensor" "$scratch/sites-strong-$sensor"
    done
    join "$enrolled" "$seen"
    for site in none gallery; do
        # shellcheck disable=SC2016
        printf '| `%s` | `%s` | %s |' "$enrolled" "$seen" "$([ "$site" = none ] && echo 'as it is' || echo adapted)"
        evaluate "$enrolled" "$seen" "$site"
    done
done
