#!/usr/bin/env bash
# Builds and runs the tests under a sanitizer and sums up in one line.
#   address, undefined  one build has both: every test program, OpenGL and child processes too
#   thread              every box with threads, oneTBB replaced by a stand-in that the sanitizer sees through
# Usage: scripts/sanitize.sh address|undefined|thread [--quick] [ctest options...]
#   --quick  builds the boxes that read files and share grids only: minutes, for continuous integration. In a folder where more is
#            built already, the tests of all that is built run.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
case "${1:-}" in
  address | undefined) preset=asan-ubsan ;;
  thread) preset=tsan ;;
  *)
    echo "sanitize: give address, undefined or thread" >&2
    exit 2
    ;;
esac
what=$1
shift
quick=0
if [[ "${1:-}" == --quick ]]; then
  quick=1
  shift
fi
bash scripts/install-dependencies.sh build test

# Programs of boxes with threads. Those of pictures and of the whole program are told from these by name below.
threaded=(bake_record_error bake_sampling bake_tracer cluster db_bake db_database db_density db_lookup effects fuzz_replay hair image
  reference satf shading shadow simulate simulation_properties solids strand_shape voxel_grid)
quick_address=(data_schema db_density fuzz_replay shading shadow)
quick_thread=(db_density shading shadow)

# The installed-package tests build a consumer without sanitizers, which cannot link sanitized libraries; the pages are checked
# in a browser, which is not ours.
exclude='bench|packaging|web'
here=$PWD/tests/sanitizers
export ASAN_OPTIONS=detect_stack_use_after_return=1:strict_string_checks=1:allocator_may_return_null=1${ASAN_OPTIONS:+:$ASAN_OPTIONS}
export LSAN_OPTIONS=suppressions=$here/leaks.supp:print_suppressions=0${LSAN_OPTIONS:+:$LSAN_OPTIONS}
export UBSAN_OPTIONS=print_stacktrace=1${UBSAN_OPTIONS:+:$UBSAN_OPTIONS}
export TSAN_OPTIONS=suppressions=$here/threads.supp:halt_on_error=1:second_deadlock_stack=1${TSAN_OPTIONS:+:$TSAN_OPTIONS}

targets=(all)
if [[ $what == thread ]]; then targets=("${threaded[@]/#/test_}" planted_race); fi
if ((quick)) && [[ $what == thread ]]; then targets=("${quick_thread[@]/#/test_}" planted_race); fi
if ((quick)) && [[ $what != thread ]]; then targets=("${quick_address[@]/#/test_}"); fi
configure "$preset"
build "$preset" "${targets[@]}"
built=$SECONDS

report=$PWD/$build_root/sanitize-$what.xml
status=0
rm -f "$report"
# What was not built is registered by the name <program>_NOT_BUILT; tests that are scripts run with the whole only.
only=()
if [[ ${targets[0]} != all ]]; then only=(--exclude-regex '_NOT_BUILT$|^(hard|image|packaging|web)\.'); fi
ctest --test-dir "$build_root/$preset" --no-tests=error --output-on-failure --output-junit "$report" --label-exclude "$exclude" \
  "${only[@]}" --parallel "$(nproc)" --timeout 3000 "$@" || status=$?
python3 scripts/summarize-tests.py "$report" || status=1
echo "sanitize $what: built in $built s, tested in $((SECONDS - built)) s"
exit "$status"
