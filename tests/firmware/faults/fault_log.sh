#!/bin/bash
# Runs a program that tries faults, and keeps its output for tests/gate/summary.sh. The exit status is that of the program.
# usage: fault_log.sh BUILD NAME COMMAND...
set -euo pipefail
logs=$1/Testing/faults
name=$2
shift 2
mkdir -p "$logs"
"$@" | tee "$logs/$name.log"
