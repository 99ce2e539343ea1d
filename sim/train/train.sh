#!/bin/sh
# Makes the data files that ship with the product, as they are committed: head.model, and
# cohort.templates, which has to be made again whenever the extractor or the head model changes.
# usage: train.sh ISOTHERM_SIM ICT_DIRECTORY DATA_DIRECTORY
set -eu
sim=$1 ict=$2 data=$3
"$sim" train head --ict "$ict" --seed 1 --out "$data/head.model"
"$sim" train cohort --ict "$ict" --seed 1 --model "$data/head.model" \
    --sensor astra,d435,kinect2,truedepth --people 64 --out "$data/cohort.templates"
