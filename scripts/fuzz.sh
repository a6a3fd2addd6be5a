#!/usr/bin/env bash
# Fuzzes the readers with libFuzzer under the address and undefined-behaviour sanitizers: each harness of tests/fuzz replays
# its kept corpus, then searches from a fixed seed, as many at a time as there are cores. Prints a table; a finding's path
# and exit code 1. The tree stays clean: corpora grow in build/fuzz/runs, findings stay there.
# Usage: scripts/fuzz.sh [seconds per harness, default 60] [harness...]
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
seconds=60
if [[ "${1:-}" =~ ^[0-9]+$ ]]; then
  seconds=$1
  shift
fi
if ((seconds == 0)); then
  echo "fuzz: 0 seconds would never end: give at least 1" >&2
  exit 2
fi
bash scripts/install-dependencies.sh build test
mkdir -p build
{ configure fuzz && build fuzz fuzzers; } > build/fuzz-build.log 2>&1 || { cat build/fuzz-build.log; exit 1; }

bin=build/fuzz/tests/fuzz
runs=build/fuzz/runs
rm -rf "$runs"
mkdir -p "$runs/findings"
"$bin/fuzz_seeds" "$runs/corpus"
if (($# == 0)); then set -- $(ls "$runs/corpus"); fi

# Files in memory, where there is room for them.
TMPDIR=$(mktemp -d -p "$([[ -w /dev/shm ]] && echo /dev/shm || echo /tmp)")
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT

# The keys of the JSON schemas are the words of the JSON harnesses.
grep -ohE '"[A-Za-z0-9_-]+"' data_schema/schemas/*.json | sort -u > "$runs/json.dict"

# fuzz_one <harness>: log in runs/<harness>.log
fuzz_one() {
  local harness=$1 max_len=4096 dictionary=tests/fuzz/$1.dict
  local corpus=$runs/corpus/$harness log=$runs/$harness.log
  if [[ ! -x "$bin/fuzz_$harness" ]]; then
    echo "there is no harness $harness" | tee "$log"
    return 1
  fi
  case "$harness" in
    json_*) dictionary=$runs/json.dict ;;
    database) max_len=65536 ;;
  esac
  local options=(-malloc_limit_mb=256 -rss_limit_mb=2048 -timeout=5 "-max_len=$max_len" "-artifact_prefix=$runs/findings/$harness-")
  if [[ -d tests/fuzz/corpus/$harness ]]; then cp tests/fuzz/corpus/"$harness"/* "$corpus"; fi
  if [[ -f "$dictionary" ]]; then options+=("-dict=$dictionary"); fi
  "$bin/fuzz_$harness" "${options[@]}" -runs=0 "$corpus" > "$log" 2>&1 &&
    "$bin/fuzz_$harness" "${options[@]}" -seed=1 -max_total_time="$seconds" -print_final_stats=1 "$corpus" >> "$log" 2>&1
}
export -f fuzz_one
export bin runs seconds
failed=0
printf '%s\n' "$@" | xargs -P "$(nproc)" -I{} bash -c 'fuzz_one {}' || failed=1

printf '%-16s %12s %8s %9s %9s %8s  %s\n' harness executions per_s coverage features corpus result
for harness in "$@"; do
  log=$runs/$harness.log
  read -r coverage features corpus < <(sed -nE 's/.* cov: ([0-9]+) ft: ([0-9]+) corp: ([0-9]+).*/\1 \2 \3/p' "$log" | tail -1) || true
  stat() { sed -nE "s/^stat::$1: *//p" "$log"; }
  result=clean
  if ! grep -q '^stat::' "$log" || ls "$runs/findings/$harness-"* > /dev/null 2>&1; then
    result=$(ls "$runs/findings/$harness-"* 2> /dev/null | head -1 || true)
    result="FOUND ${result:-nothing to reproduce, see $log}"
    failed=1
  fi
  printf '%-16s %12s %8s %9s %9s %8s  %s\n' "$harness" "$(stat number_of_executed_units)" "$(stat average_exec_per_sec)" \
    "${coverage:-}" "${features:-}" "${corpus:-}" "$result"
done
for log in $(grep -LE '^stat::' "$runs"/*.log); do
  echo "== $log"
  grep -nE 'ERROR|Broken|what\(\)|^terminate|SUMMARY|^Base64|^ +#[0-9]+ ' "$log" | head -40
done
exit "$failed"
