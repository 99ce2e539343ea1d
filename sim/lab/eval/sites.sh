#!/bin/sh
# Measures what a site of 5, 10, 30 and 100 people gains from its own statistics, before several sensors: how many non-mated comparisons
# reach the scores 2, 3 and 4, whose promises are 1 %, 0.1 % and 0.01 %, by the metric as it is and adapted to the enrolled people
# (eval --site gallery). The people are those of preset strong, two frames of each visit. Everybody who is not enrolled is a stranger.
# SCRATCH keeps the corpora (sites-SENSOR), which are rendered only if they are missing, and the reports (sites-SENSOR-PEOPLE-SITE).
# The environment may set SENSORS and PEOPLE.
# usage: sites.sh ISOTHERM_SIM ICT_DIRECTORY DATA_DIRECTORY SCRATCH
set -eu
sim=$1 ict=$2 data=$3 scratch=$4
. "$(dirname "$0")/../../corpus/generate_once.sh"
export OPENBLAS_NUM_THREADS=1
mkdir -p "$scratch"

# evaluate SENSOR PEOPLE SITE: prints the rates as cells of a table
evaluate() {
    out=$scratch/sites-$1-$2-$3
    mkdir -p "$out"
    "$sim" eval --corpus "$scratch/sites-$1" --fuse 1 --gallery-limit "$2" --site "$3" --model "$data/head.model" \
        --metric "$data/face.metric" --out "$out" >"$out/report.txt"
    awk '/^Promise:/ { here = 1; next }
         here && $1 >= 2 && $1 <= 4 && NF == 5 { printf " %.2f %s %.2f] |", $3, substr($4, 1, length($4) - 3) ",", $5 }
         /^  Cllr/ { here = 0 }' "$out/report.txt"
    awk '$1 == "3.0" && NF == 6 { printf " %.2f |", $6 }' "$out/report.txt"
}

echo '| sensor | people | site | reach 2, % | reach 3, % | reach 4, % | mated lost at 3, % |'
echo '| --- | --- | --- | --- | --- | --- | --- |'
for sensor in ${SENSORS:-truedepth d435 astra kinect2}; do
    generate_once "$sim" "$ict" "$scratch/sites-$sensor" --preset strong --sensor "$sensor" --seed 1701 --people 100 --probes 100 --strangers 0 \
        --frames-per-visit 2
    for people in ${PEOPLE:-5 10 30 100}; do
        for site in none gallery; do
            # shellcheck disable=SC2016
            printf '| `%s` | %s | %s |' "$sensor" "$people" "$site"
            evaluate "$sensor" "$people" "$site"
            echo
        done
    done
done
