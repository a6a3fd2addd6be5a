#!/usr/bin/env bash
# Installs what is missing, builds the release preset with its tests, checks the format, runs the tests, fuzzes the readers for
# PELAGE_FUZZ_SECONDS each (default 60, 0: not at all) where all tests passed. The last line sums up. Fails where a test fails or
# none is found. Usage: scripts/test.sh [ctest options...]
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
bash scripts/install-dependencies.sh build test
build_tests
bash scripts/check-format.sh

report=$PWD/$build_root/tests.xml
fuzz_seconds=${PELAGE_FUZZ_SECONDS:-60}
status=0
rm -f "$report"
ctest --test-dir "$build_root/release" --no-tests=error --output-on-failure --output-junit "$report" --label-exclude bench \
  --parallel "$(nproc)" "$@" || status=$?
if ((status != 0)); then fuzz_seconds=0; fi
if ((fuzz_seconds > 0)); then bash scripts/fuzz.sh "$fuzz_seconds" || status=$?; fi
python3 scripts/summarize-tests.py "$report" --fuzzed "$fuzz_seconds" || status=1
exit "$status"
