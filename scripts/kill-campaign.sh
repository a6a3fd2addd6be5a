#!/usr/bin/env bash
# Kills a bake at random moments, resumes it, and compares the bytes with an undisturbed bake's.
# Usage: scripts/kill-campaign.sh [kills, default 200] [seed, default of the day]
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
bash scripts/install-dependencies.sh build test
configure release -DPELAGE_BUILD_TESTS=ON
build release test_faults_kill
PELAGE_KILLS=${1:-200} PELAGE_KILL_SEED=${2:-$(date +%Y%m%d)} build/release/tests/faults/test_faults_kill
