#!/usr/bin/env bash
# Builds and runs every program of tests/bench: a table on stdout and in build/bench/NAME.txt, JSON in build/bench/NAME.json.
# Usage: scripts/bench.sh [Google Benchmark options...]
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
bash scripts/install-dependencies.sh
build release -DPELAGE_BUILD_BENCHMARKS=ON
mkdir -p build/bench
shopt -s nullglob
programs=(build/release/tests/bench/bench_*)
if ((${#programs[@]} == 0)); then
  echo "bench: no programs in tests/bench" >&2
  exit 1
fi
for program in "${programs[@]}"; do
  [[ -f "$program" && -x "$program" ]] || continue
  name=$(basename "$program")
  echo "== $name"
  "$program" --benchmark_out="build/bench/$name.json" --benchmark_out_format=json "$@" | tee "build/bench/$name.txt"
done
