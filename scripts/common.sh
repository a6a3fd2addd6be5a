# shellcheck shell=bash
# Shared by the scripts: goes to the repository's root, configures and builds presets. Demo, tests and benches share one build:
# the same flags, and an option that one of them has set stays set, so that none compiles again what another has compiled.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build_root=${PELAGE_BUILD_ROOT:-build}

# configure <preset> [cmake options...]: in build/<preset>. A compiler cache is used where it is there when the folder is new (or
# CMAKE_CXX_COMPILER_LAUNCHER of the environment), and none after that: it is a part of every command, and other commands would
# compile everything again.
configure() {
  local preset=$1 folder=$build_root/$1 launcher=()
  shift
  if [[ ! -f "$folder/CMakeCache.txt" && -z "${CMAKE_CXX_COMPILER_LAUNCHER:-}" ]] && command -v ccache > /dev/null; then
    launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  fi
  cmake --preset "$preset" -B "$folder" "${launcher[@]}" "$@"
}

# build <preset> <target>...
build() {
  local preset=$1
  shift
  cmake --build "$build_root/$preset" --target "$@"
}

# What the demo, the tests and the benches need built. tests/packaging/one_build_test.py holds them against each other.
build_programs() { configure release && build release pelage pelage-bake; }
build_tests() { configure release -DPELAGE_BUILD_TESTS=ON && build release all; }
build_benches() { configure release -DPELAGE_BUILD_BENCHMARKS=ON && build release benches; }
