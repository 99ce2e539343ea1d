#!/bin/sh
# Counts the instructions of one picture of isotherm-screen (valgrind), and the share of a core of a Raspberry Pi 4 that 15 pictures a
# second take: a Cortex-A72 of 1.5 GHz that executes one instruction a cycle. It measures and does not judge.
#
#   instructions.sh BUILD
set -eu
program=$1/tests/bench/screen_pictures
scratch=$(mktemp -d)
trap 'rm -r "$scratch"' EXIT

# count WIDTH HEIGHT PICTURES
count() {
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$program" "$@" 2>&1 | sed -n 's/.*Collected : *//p'
}

for size in '320 240' '800 480' '1920 1080'; do
    # Two runs: fonts are loaded once.
    # shellcheck disable=SC2086
    few=$(count $size 10)
    # shellcheck disable=SC2086
    many=$(count $size 40)
    echo "$size $few $many" | awk '{
        one = ($4 - $3) / 30
        printf "%9s  %6.2f million instructions a picture, %5.1f %% of a core at 15 a second; start %.0f million\n",
            $1 "x" $2, one / 1e6, 100 * 15 * one / 1.5e9, ($3 - 10 * one) / 1e6 }'
done
