#!/bin/sh
# Installs what is missing, builds everything into build/dev and runs the tests: sh tests/run.sh [CTEST-OPTION...]
# Ends with the time that each phase took, and the ten slowest steps. Warnings are errors if RAYCONE_WERROR=ON is set in
# the environment. The sources of a folder are compiled together, which halves their time; RAYCONE_UNITY=OFF compiles
# each alone, which is better while you change them.
set -eu
cd "$(dirname "$0")/.."
. tests/phases.sh
jobs=$(nproc)
test_jobs=$((jobs + 1))  # tests wait for disks and for each other
rm -f build/phases.tsv

phase 'install packages' sh app/install_packages.sh --tests
phase 'configure' cmake --preset dev -DRAYCONE_WERROR="${RAYCONE_WERROR:-OFF}" \
  -DRAYCONE_UNITY="${RAYCONE_UNITY:-ON}"
phase 'build' cmake --build --preset dev --parallel "$jobs"
phase 'test' ctest --preset dev --parallel "$test_jobs" --output-log build/dev/ctest.log "$@"
sh tests/check_skipped.sh build/dev/ctest.log build/dev
python3 tests/slowest_steps.py build
