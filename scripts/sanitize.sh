#!/usr/bin/env bash
# Builds and tests with the address and undefined-behaviour sanitizers; `scripts/sanitize.sh tsan` with the thread sanitizer.
# Usage: scripts/sanitize.sh [asan-ubsan|tsan] [ctest options...]
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
preset=${1:-asan-ubsan}
bash scripts/install-dependencies.sh
build "$preset"
# The installed-package test builds a consumer without sanitizers, which cannot link sanitized libraries.
ctest --test-dir "build/$preset" --output-on-failure --label-exclude 'bench|packaging' --parallel "$(nproc)" "${@:2}"
