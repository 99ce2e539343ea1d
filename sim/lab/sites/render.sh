#!/bin/sh
# Renders the people of a site unless their corpus is there already: 100 people of a preset before one sensor, two frames of each visit,
# and nobody else. The same preset gives the same people and the same visits before every sensor.
# usage: render.sh ISOTHERM_SIM ICT_DIRECTORY PRESET SENSOR CORPUS
set -eu
sim=$1 ict=$2 preset=$3 sensor=$4 corpus=$5
export OPENBLAS_NUM_THREADS=1
if [ ! -e "$corpus/manifest.csv" ]; then
    rm -rf "${corpus:?}" # remains of an interrupted run
    "$sim" generate --ict "$ict" --preset "$preset" --sensor "$sensor" --seed 1701 --people 100 --probes 100 --strangers 0 \
        --frames-per-visit 2 --out "$corpus"
fi
