#!/bin/sh
# Prints how many test cases of the last ctest run of a build passed, failed and were skipped. Each case of a cmocka program counts, and
# each other test counts as one case. Before that it prints the last lines of make drill, make kills and make storage-faults: those of the
# whole runs if there were any, otherwise those of the runs within the tests.
# usage: summary.sh BUILD
set -eu
# shellcheck source=tests/support/verdict.sh
. "$(dirname "$0")/../support/verdict.sh"
logs=$1/Testing/Temporary
skipped=$logs/LastTestsDisabled.log # ctest's list of tests that were skipped as a whole
[ -f "$skipped" ] || skipped=/dev/null

for what in drill kills 'storage faults'; do
    whole=$1/Testing/faults/$(echo "$what" | tr ' ' -).log
    if [ -f "$whole" ]; then
        tail -n 1 "$whole" | grep "^$what: " || echo "$what: did not come to an end"
    else
        grep "^$what: [0-9]* faults\\{0,1\\} tried " "$logs/LastTest.log" || true
    fi
done

awk -v skipped_list="$skipped" '
BEGIN {
    while ((getline line < skipped_list) > 0) {
        sub(/^[0-9]*:/, "", line)
        skipped_whole[line] = 1
    }
}
/^[0-9]+\/[0-9]+ Testing: / {
    name = $3
    cases = failed_here = 0
}
/^\[==========\] [0-9]+ test\(s\) run\./ { cases = 1 }
cases && /^\[  PASSED  \] [0-9]+ test\(s\)/ { passed += $4 }
cases && /^\[  SKIPPED \] [0-9]+ test\(s\)/ { skipped += $4 }
cases && /^\[  FAILED  \] [0-9]+ test\(s\)/ { failed += $4; failed_here = $4 }
/^Test Passed\.$/ && name in skipped_whole { skipped++; next }
/^Test Passed\.$/ && !cases { passed++ }
/^Test (Failed|Timeout)/ && !failed_here { failed++ }
END {
    print passed + 0, failed + 0, skipped + 0
}' "$logs/LastTest.log" | {
    read -r passed failed skipped
    say_tally "$passed" "$failed" "$skipped"
}
