#!/bin/sh
# Gate: the exposure of the unit by systemd's rating (0 is the least, 10 the most) is at most MOST.
# usage: unit.sh UNIT MOST      ends with 77 (skipped) where there is no systemd-analyze
set -eu
command -v systemd-analyze >/dev/null || { echo 'skipped: no systemd-analyze'; exit 77; }
line=$(systemd-analyze security --offline=yes --no-pager "$1" | grep 'Overall exposure level')
level=$(printf '%s\n' "$line" | sed 's/.*: \([0-9.]*\) .*/\1/')
echo "exposure $level, at most $2"
awk -v level="$level" -v most="$2" 'BEGIN { exit !(level != "" && level + 0 <= most) }'
