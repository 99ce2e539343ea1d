#!/bin/bash
# Runs a program that tries faults and keeps what it says, for tests/gate/summary.sh. Its exit status is that of the program.
# usage: fault_log.sh BUILD NAME COMMAND...
set -euo pipefail
logs=$1/Testing/faults
name=$2
shift 2
mkdir -p "$logs"
"$@" | tee "$logs/$name.log"
