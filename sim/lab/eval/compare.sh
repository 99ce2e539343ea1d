#!/bin/sh
# Makes every figure of the documents that compares: all methods on all corpora in one table (table), what frames fused gain
# (fused), a thousand people enrolled (thousand), and what a score means before each sensor (sensors). The metric and the methods
# that learn have seen none of these people; eval refuses if they have. SCRATCH keeps the corpora, which are rendered only if they
# are not there, and the results (SCRATCH/results). DATA: head.model and face.metric. KINECT2: a corpus of real frames, or -. The
# environment may name METHODS for the table (all): hfpc-literal solves for 100 eigenpairs a face, which takes the most time.
# usage: compare.sh ISOTHERM_SIM ICT_DIRECTORY DATA_DIRECTORY KINECT2_DIRECTORY SCRATCH [table] [fused] [thousand] [sensors]
set -eu
sim=$1 ict=$2 data=$3 real=$4 scratch=$5
shift 5
export OPENBLAS_NUM_THREADS=1
mkdir -p "$scratch/results"

# render NAME OPTION...: the corpus of this name
render() {
    name=$1
    shift
    if [ ! -e "$scratch/$name/manifest.csv" ]; then
        rm -rf "${scratch:?}/$name" # what an interrupted run has left
        "$sim" generate --ict "$ict" "$@" --out "$scratch/$name"
    fi
}

# evaluate RESULT OPTION...
evaluate() {
    result=$1
    shift
    mkdir -p "$scratch/results/$result"
    "$sim" eval --model "$data/head.model" --metric "$data/face.metric" --out "$scratch/results/$result" "$@" \
        >"$scratch/results/$result/report.txt"
}

table() {
    render train --preset strong --population train --seed 4001 --people 120 --probes 360 --strangers 0 --marks
    corpora=
    for preset in mild strong texas hard pose far; do
        render $preset --preset $preset --seed 4
        corpora="$corpora --corpus $scratch/$preset"
    done
    [ "$real" = - ] || corpora="$corpora --corpus $real"
    # shellcheck disable=SC2086
    evaluate table --method "${METHODS:-all}" --train "$scratch/train" $corpora
    sed -n '/^Methods on/,$p' "$scratch/results/table/report.txt"
}

# What frames that are fused gain: each visit of eight frames is eight samples of one, four of two, ...
# Enrolled with one frame, whose errors no later frame mends, and with as many as are searched with.
# The environment may name PRESETS (mild strong hard) and FUSED, how many are enrolled and searched with.
fused() {
    for preset in ${PRESETS:-mild strong hard}; do
        render "$preset-8" --preset "$preset" --seed 5 --frames-per-visit 8 --people 60 --probes 180 --strangers 60
        for enrolled_frames in ${FUSED:-1-1 1-2 1-4 1-8 2-2 4-4 8-8}; do
            enrolled=${enrolled_frames%-*} frames=${enrolled_frames#*-}
            result=$preset-fused-$enrolled_frames
            evaluate "$result" --corpus "$scratch/$preset-8" --gallery-frames "$enrolled" --fuse "$frames"
            echo "$preset, $enrolled enrolled, $frames fused:"
            grep -E '^  (EER|FNMR at FMR|rank 1) ' "$scratch/results/$result/report.txt"
        done
    done
}

thousand() {
    render thousand --preset mild --seed 6 --people 1000 --probes 1000 --strangers 500
    evaluate thousand --corpus "$scratch/thousand"
    sed -n '/^Identification/,/^By condition/p' "$scratch/results/thousand/report.txt"
}

# The environment may name SENSORS.
sensors() {
    for sensor in ${SENSORS:-astra kinect2 d435 truedepth stereo}; do
        render sensor-$sensor --preset strong --seed 7 --sensor $sensor --people 100 --probes 200 --strangers 100
        evaluate sensor-$sensor --corpus "$scratch/sensor-$sensor"
        echo "$sensor:"
        sed -n '/^  EER/p; /^  FNMR/p; /^Calibration/,/^Identification/p' "$scratch/results/sensor-$sensor/report.txt"
    done
}

[ $# -gt 0 ] || set -- table fused thousand sensors
for part; do
    case $part in
    table | fused | thousand | sensors) "$part" ;;
    *)
        echo "compare.sh: no part '$part'" >&2
        exit 2
        ;;
    esac
done
