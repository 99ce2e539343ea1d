#!/bin/sh
# Renders the people of a site unless their corpus is there already: 100 people of a preset before one sensor, two frames of each visit,
# and nobody else. The same preset gives the same people and the same visits before every sensor.
# usage: render.sh ISOTHERM_SIM ICT_DIRECTORY PRESET SENSOR CORPUS
set -eu
. "$(dirname "$0")/../../corpus/generate_once.sh"
export OPENBLAS_NUM_THREADS=1
generate_once "$1" "$2" "$5" --preset "$3" --sensor "$4" --seed 1701 --people 100 --probes 100 --strangers 0 --frames-per-visit 2
