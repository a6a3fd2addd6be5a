#!/usr/bin/env bash
# clang-format over the tracked C++ files; --fix rewrites them.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
mode=(--dry-run --Werror)
if [[ "${1:-}" == --fix ]]; then mode=(-i); fi
git ls-files -z '*.h' '*.cpp' | xargs -0 --no-run-if-empty clang-format "${mode[@]}"
