#!/bin/sh
# Makes all figures of comparisons in the documents: all methods on all corpora in one table (table), the gain from fused frames
# (fused), a thousand people enrolled (thousand), and the meaning of a score with each sensor (sensors). The metric and the methods that
# learn did not learn from any of these people; eval refuses otherwise. SCRATCH keeps the corpora, which are rendered only if they are
# missing, and the results (SCRATCH/results). DATA: head.model and face.metric. KINECT2: a corpus of real frames, or -. The environment
# may set METHODS for the table (all); hfpc-literal takes the most time, because it solves for 100 eigenpairs of each face.
# usage: compare.sh ISOTHERM_SIM ICT_DIRECTORY DATA_DIRECTORY KINECT2_DIRECTORY SCRATCH [table] [fused] [thousand] [sensors]
set -eu
sim=$1 ict=$2 data=$3 real=$4 scratch=$5
shift 5
. "$(dirname "$0")/../../corpus/generate_once.sh"
export OPENBLAS_NUM_THREADS=1
mkdir -p "$scratch/results"

# render NAME OPTION...: renders the corpus of this name
render() {
    name=$1
    shift
    generate_once "$sim" "$ict" "$scratch/$name" "$@"
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

# The gain from fused frames: each visit of eight frames is eight samples of one frame, four of two, ...
# People are enrolled once with one frame, whose errors later frames do not correct, and once with as many frames as the searches use.
# The environment may set PRESETS (mild strong hard) and FUSED, the numbers of frames for enrolment and search.
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

# The environment may set SENSORS.
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
