#!/bin/sh
# Measures the security levels for the README's table with `isotherm-sim levels`, by the metric as it is and adapted to the enrolled
# people (`[match] adapt`), side by side. A group has 100 enrolled people, VISITS visits of them and STRANGERS strangers with one visit
# each (preset mild), and 100 enrolled people with ALIKE visits of strangers who look like them (preset hard). Without other numbers in
# the environment there are five groups with 200 visits of each kind: a thousand visits of each. No parameter was chosen on these seeds;
# the rules of the decision were chosen on the seeds 1501 and 1601.
# SCRATCH keeps the corpora (4 GB), which are rendered only if they are missing, and the results (SCRATCH/levels, which is deleted first).
# Two corpora are rendered at a time. It takes about an hour of one x86 core, 35 minutes of it for rendering; GROUP_COUNT=1 STRANGERS=300
# ALIKE=100 makes a fifth of the visits.
# With REAL, a corpus of single real frames, it also makes visits of these (real_visits.sh) and measures them (SCRATCH/levels-real).
# The environment may set GROUP_COUNT, VISITS, STRANGERS, ALIKE, ADAPT (no, yes or both) and REAL.
# usage: levels.sh ISOTHERM_SIM ICT_DIRECTORY DATA_DIRECTORY SCRATCH
set -eu
sim=$1 ict=$2 data=$3 scratch=$4
. "$(dirname "$0")/../corpus/generate_once.sh"
groups=${GROUP_COUNT:-5} visits=${VISITS:-200} strangers=${STRANGERS:-200} alike=${ALIKE:-200} adapt=${ADAPT:-both} real=${REAL:-}
export OPENBLAS_NUM_THREADS=1
mkdir -p "$scratch"

# render PRESET SEED VISITS_OF_ENROLLED_PEOPLE STRANGERS
render() {
    generate_once "$sim" "$ict" "$scratch/$1-$2" --preset "$1" --seed "$2" --people 100 --probes "$3" --strangers "$4" --frames-per-visit 7
}

# measure RESULT OPTION...
measure() {
    result=$1
    shift
    rm -rf "${scratch:?}/$result"
    "$sim" levels --adapt "$adapt" --model "$data/head.model" --metric "$data/face.metric" "$@" --out "$scratch/$result"
}

set --
group=2
while [ "$group" -lt $((groups + 2)) ]; do
    render hard $((1600 + group)) 0 "$alike" &
    render mild $((1500 + group)) "$visits" "$strangers"
    wait "$!"
    set -- "$@" --corpus "$scratch/mild-$((1500 + group))" --alike "$scratch/hard-$((1600 + group))"
    group=$((group + 1))
done
status=0 # 1: strangers were let in too often (isotherm-sim levels); the other measurement is made all the same
measure levels "$@" || status=$?

[ -n "$real" ] || exit "$status"
rm -rf "${scratch:?}/real"
"$(dirname "$0")/real_visits.sh" "$real" "$scratch/real"
set --
for corpus in "$scratch/real/all" "$scratch"/real/without-*; do
    set -- "$@" --corpus "$corpus"
done
echo
measure levels-real "$@" || status=$?
exit "$status"
