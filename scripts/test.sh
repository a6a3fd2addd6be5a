#!/usr/bin/env bash
# Installs what is missing, builds the release preset with warnings as errors, checks the format, runs the tests, fuzzes
# the readers for PELAGE_FUZZ_SECONDS each (default 60, 0: not at all). Usage: scripts/test.sh [ctest options...]
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
bash scripts/install-dependencies.sh
build release -DCMAKE_COMPILE_WARNING_AS_ERROR=ON
bash scripts/check-format.sh
ctest --test-dir build/release --output-on-failure --label-exclude bench --parallel "$(nproc)" "$@"
if ((${PELAGE_FUZZ_SECONDS:-60} > 0)); then bash scripts/fuzz.sh "${PELAGE_FUZZ_SECONDS:-60}"; fi
