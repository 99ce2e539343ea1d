#!/bin/sh
# Gate: the exposure of each unit by systemd's rating (0 is the least, 10 the most) is at most MOST.
# usage: unit.sh UNIT MOST [UNIT MOST...]      ends with 77 (skipped) where there is no systemd-analyze
set -eu
command -v systemd-analyze >/dev/null || { echo 'skipped: no systemd-analyze'; exit 77; }
faults=0
while [ $# -gt 0 ]; do
    line=$(systemd-analyze security --offline=yes --no-pager "$1" | grep 'Overall exposure level')
    level=$(printf '%s\n' "$line" | sed 's/.*: \([0-9.]*\) .*/\1/p;d')
    echo "$(basename "$1"): exposure $level, at most $2"
    awk -v level="$level" -v most="$2" 'BEGIN { exit !(level != "" && level + 0 <= most) }' || faults=$((faults + 1))
    shift 2
done
[ "$faults" -eq 0 ]
