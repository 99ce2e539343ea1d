#!/bin/sh
# Measures what a site of 5, 10, 30 and 100 people gains from its own statistics, before several sensors: how many non-mated comparisons
# reach the scores 2, 3 and 4, whose promises are 1 %, 0.1 % and 0.01 %, by the metric as it is and adapted to the enrolled people
# (eval --site gallery). Everybody who is not enrolled is a stranger. A rate is `in` if it lies within a factor of three of its promise or
# its interval contains the promise. Otherwise it is `below` or `above`.
# SCRATCH keeps the corpora (sites-PRESET-SENSOR), which are rendered only if they are missing, and the reports
# (sites-PRESET-SENSOR-PEOPLE-SITE). The environment may set PRESET, SENSORS and PEOPLE.
# usage: promise.sh ISOTHERM_SIM ICT_DIRECTORY DATA_DIRECTORY SCRATCH
set -eu
sim=$1 ict=$2 data=$3 scratch=$4
preset=${PRESET:-strong}
here=$(dirname "$0")
export OPENBLAS_NUM_THREADS=1
mkdir -p "$scratch"

# evaluate SENSOR PEOPLE SITE: prints the rates as cells of a table
evaluate() {
    corpus=$scratch/sites-$preset-$1
    out=$corpus-$2-$3
    mkdir -p "$out"
    "$sim" eval --corpus "$corpus" --fuse 1 --gallery-limit "$2" --site "$3" --model "$data/head.model" --metric "$data/face.metric" \
        --out "$out" >"$out/report.txt"
    awk '/^  EER / && !eer { eer = $2 }
         $1 == "3.0" && NF == 6 { lost = $6 }
         /^Promise:/ { promises = 1; next }
         /^  Cllr/ { promises = 0 }
         promises && $1 >= 2 && $1 <= 4 && NF == 5 {
             promised = $2 + 0; rate = $3 + 0; least = substr($4, 2) + 0; most = $5 + 0
             near = rate >= promised / 3 && rate <= promised * 3 || least <= promised && promised <= most
             verdict = verdict (verdict ? ", " : "") (near ? "in" : rate < promised ? "below" : "above")
             printf " %.2f [%.2f, %.2f] |", rate, least, most
         }
         END { printf " %s | %.2f | %.2f |\n", verdict, lost, eer }' "$out/report.txt"
}

echo '| preset, sensor | people | site | reach 2, % | reach 3, % | reach 4, % | promises at 2, 3, 4 | mated lost at 3, % | EER, % |'
echo '| --- | --- | --- | --- | --- | --- | --- | --- | --- |'
for sensor in ${SENSORS:-truedepth d435 astra kinect2}; do
    "$here/render.sh" "$sim" "$ict" "$preset" "$sensor" "$scratch/sites-$preset-$sensor"
    for people in ${PEOPLE:-5 10 30 100}; do
        for site in none gallery; do
            # shellcheck disable=SC2016
            printf '| `%s`, `%s` | %s | %s |' "$preset" "$sensor" "$people" "$site"
            evaluate "$sensor" "$people" "$site"
        done
    done
done
