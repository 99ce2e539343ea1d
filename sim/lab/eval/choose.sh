#!/bin/sh
# Compares radii, smoothing and landmarks with each class of sensor. Each sensor has one table: all settings are compared by distance, and
# the shipped setting also by the learned metric. People and seed are not used elsewhere. SCRATCH keeps the corpora, which are rendered only if
# they are missing, and the results (SCRATCH/results). Existing results are not made again, so that a run can be interrupted; remove them
# after a change of the program. DATA: head.model and face.metric. The environment may set SENSORS (truedepth astra kinect2), RADII,
# SMOOTHINGS, and PEOPLE, PROBES, STRANGERS (40 80 20).
# usage: choose.sh ISOTHERM_SIM ICT_DIRECTORY DATA_DIRECTORY SCRATCH
set -eu
sim=$1 ict=$2 data=$3 scratch=$4
. "$(dirname "$0")/../../corpus/generate_once.sh"
export OPENBLAS_NUM_THREADS=1
mkdir -p "$scratch/results"

# evaluate RESULT OPTION...: evaluates the current corpus
evaluate() {
    result=$scratch/results/$1
    shift
    if [ ! -e "$result/methods.csv" ]; then
        mkdir -p "$result"
        "$sim" eval --model "$data/head.model" --corpus "$corpus" --threads 1 --out "$result" "$@" >"$result/report.txt"
    fi
}

# row METHOD TEXT: prints a text and the figures of a method in the current result; p is from the paired test over people of FNMR at
# 1e-3, against the first method of the evaluation
row() {
    awk -F, -v method="$1" -v first="$2" '
        function percent(value, low, high) { return sprintf("%5.1f [%4.1f, %5.1f]", 100 * value, 100 * low, 100 * high) }
        $2 == method {
            printf "%-28s  %s  %s  %s  %s  %s\n", first, percent($8, $9, $10), percent($16, $17, $18), percent($27, $28, $29),
                percent($21, $22, $23), (NR > 2 ? sprintf("%.4f", $25) : "")
        }' "$result/methods.csv"
}

for sensor in ${SENSORS:-truedepth astra kinect2}; do
    corpus=$scratch/choose-$sensor
    generate_once "$sim" "$ict" "$corpus" --preset strong --seed 23 --sensor "$sensor" --people "${PEOPLE:-40}" --probes "${PROBES:-80}" \
        --strangers "${STRANGERS:-20}"
    echo "$sensor, $(($(wc -l <"$corpus/manifest.csv") - 1)) frames:"
    printf '%-28s  %-20s  %-20s  %-20s  %-20s  %s\n' 'radii smoothing landmarks' 'rank 1 %' 'EER %' 'FNMR at FMR 1e-2 %' 'at 1e-3 %' p
    for radii in ${RADII:-10 18 12,20,28,36 20,28,36 28,36,44}; do
        for smoothing in ${SMOOTHINGS:-1.5 3 4.5}; do
            evaluate "$sensor-$radii-$smoothing" --method hfpc,hfpc-upper --metric none --radii "$radii" --smoothing "$smoothing"
            row hfpc "$radii $smoothing all"
            row hfpc-upper "$radii $smoothing upper"
        done
    done
    evaluate "$sensor-learned" --method hfpc-metric,hfpc --metric "$data/face.metric"
    row hfpc-metric 'shipped, learned metric'
    row hfpc 'shipped, reranked'
done
