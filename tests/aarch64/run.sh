#!/bin/bash
# Cross-builds the daemon, its client and unit tests for arm64 (preset aarch64), and runs them under qemu-aarch64-static.
#
#   run.sh BUILD [TESTS]     TESTS: names of ctest, instead of the usual ones
#
# Ends with "N passed, N failed, N skipped". Without the cross compiler or the emulator, all tests are skipped and counted.
set -euo pipefail
source_dir=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/support/verdict.sh
. "$source_dir/tests/support/verdict.sh"
root=$source_dir/build/aarch64-root
# Without the tests of V4L2, whose calls the emulator does not have, and without tests that take minutes there.
usual='test_firmware_config test_firmware_gallery test_firmware_audit test_firmware_decision test_firmware_track
    test_firmware_sensor_supervisor test_firmware_pipeline test_sensor_contract test_sensor_replay
    test_frame test_gram test_agreeing test_shape_vertices test_meet_many test_block test_supernodes test_index_codes
    test_recording test_png test_door_contract test_gpio_line test_stereo_calibration test_registration
    test_template test_shape_fit test_depth_lanes test_resample'
tests=${2:-$usual}

skip() {
    echo "skipped: $1"
    echo '0 passed, 0 failed, 1 skipped'
    exit 0
}
for program in aarch64-linux-gnu-gcc aarch64-linux-gnu-g++ qemu-aarch64-static; do
    command -v $program >/dev/null || skip "$program is not installed (cmake/install_packages.sh arm64)"
done
"$source_dir/cmake/aarch64_root.sh" "$root"
cd "$source_dir"
cmake --preset aarch64 >/dev/null
# shellcheck disable=SC2086
cmake --build --preset aarch64 --target isothermd isotherm $tests
build=$(cd "$1" && pwd)
export OPENBLAS_NUM_THREADS=1

# ---- the units ----
passed=0 failed=0 skipped=0
log=$build/arm64-check.log
# An emulated program cannot start another program, so tests that start the daemon are left out; daemon.sh below replaces them.
ctest --test-dir "$build" -j "$(nproc)" --timeout 600 --output-on-failure \
    -R "^($(echo $tests | tr ' ' '|'))\$" 2>&1 | tee "$log" || true
passed=$(grep -c ' Passed ' "$log" || true)
skipped=$(grep -c '\*\*\*Skipped' "$log" || true)
failed=$(grep -c -E '\*\*\*(Failed|Exception|Timeout|Not Run)' "$log" || true)

# ---- the daemon ----
if "$source_dir/tests/aarch64/daemon.sh" "$build"; then
    passed=$((passed + 1))
else
    failed=$((failed + 1))
fi

printf 'arm64: '
say_tally "$passed" "$failed" "$skipped"
[ "$failed" -eq 0 ] && [ "$passed" -gt 1 ]
