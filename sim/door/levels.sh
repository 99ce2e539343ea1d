#!/bin/sh
# Measures the security levels for the README's table with `isotherm-sim levels`: a thousand visits each of enrolled people, of strangers
# and of strangers who look alike. There are five groups of 100 enrolled people with 200 visits of enrolled people and 200 of strangers,
# and five groups of 100 enrolled people with 200 visits of strangers who look like them (preset hard). No parameter was chosen on these
# seeds; the rules of the decision were chosen on the seeds 1501 and 1601.
# SCRATCH keeps the corpora (4 GB), which are rendered only if they are missing, and the results (SCRATCH/levels, which is deleted first).
# It takes 50 minutes of one x86 core, 35 of them for rendering.
# usage: levels.sh ISOTHERM_SIM ICT_DIRECTORY DATA_DIRECTORY SCRATCH
set -eu
sim=$1 ict=$2 data=$3 scratch=$4
mkdir -p "$scratch"

# render PRESET SEED VISITS_OF_ENROLLED_PEOPLE
render() {
    corpus=$scratch/$1-$2
    if [ ! -e "$corpus/manifest.csv" ]; then
        rm -rf "${corpus:?}" # remains of an interrupted run
        "$sim" generate --ict "$ict" --preset "$1" --seed "$2" --people 100 --probes "$3" --strangers 200 \
            --frames-per-visit 7 --out "$corpus"
    fi
}

set --
for group in 2 3 4 5 6; do
    render mild 150$group 200
    render hard 160$group 0
    set -- "$@" --corpus "$scratch/mild-150$group" --alike "$scratch/hard-160$group"
done
rm -rf "${scratch:?}/levels"
"$sim" levels --model "$data/head.model" --metric "$data/face.metric" "$@" --out "$scratch/levels"
