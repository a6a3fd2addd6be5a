#!/usr/bin/env bash
# Builds and runs every program of tests/bench: a table on stdout and in build/bench/NAME.txt, JSON in build/bench/NAME.json.
# Usage: scripts/bench.sh [--build-only | Google Benchmark options...]
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
bash scripts/install-dependencies.sh build bench
build_benches
if [[ "${1:-}" == --build-only ]]; then exit 0; fi
mkdir -p build/bench
for program in "$build_root"/release/tests/bench/bench_*; do
  [[ -f "$program" && -x "$program" ]] || continue
  name=$(basename "$program")
  echo "== $name"
  "$program" --benchmark_out="build/bench/$name.json" --benchmark_out_format=json "$@" | tee "build/bench/$name.txt"
done
