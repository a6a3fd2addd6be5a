# shellcheck shell=bash
# Shared by the scripts: goes to the repository's root, and configures and builds a preset.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# build <preset> [cmake options...]: into build/<preset>, with ccache where it is there. TARGETS="a b" builds only those.
build() {
  local preset=$1
  shift
  local launcher=()
  if command -v ccache > /dev/null; then launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
  cmake --preset "$preset" "${launcher[@]}" "$@"
  # shellcheck disable=SC2086
  cmake --build "build/$preset" ${TARGETS:+--target $TARGETS}
}
