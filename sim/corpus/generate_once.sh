#!/bin/sh
# A function for the scripts that measure. They include this file.

# generate_once ISOTHERM_SIM ICT_DIRECTORY CORPUS OPTION...: renders a corpus, unless an earlier run has rendered it completely
generate_once() {
    if [ ! -e "$3/manifest.csv" ]; then
        rm -rf "${3:?}" # remains of an interrupted run
        generate_sim=$1 generate_ict=$2 generate_out=$3
        shift 3
        "$generate_sim" generate --ict "$generate_ict" "$@" --out "$generate_out"
    fi
}
