#!/bin/sh
# Installs what is missing, builds everything into build/dev and runs the tests: sh tests/run.sh [CTEST-OPTION...]
# Ends with the time that each phase took, and the ten slowest steps. Warnings are errors where RAYCONE_WERROR=ON is set in
# the environment.
set -eu
cd "$(dirname "$0")/.."
. tests/phases.sh
jobs=$(nproc)
rm -f build/phases.tsv

phase 'install packages' sh app/install_packages.sh --tests
phase 'configure' cmake --preset dev -DRAYCONE_WERROR="${RAYCONE_WERROR:-OFF}"
phase 'build' cmake --build --preset dev --parallel "$jobs"
phase 'test' ctest --preset dev --parallel "$jobs" --output-log build/dev/ctest.log "$@"
sh tests/check_skipped.sh build/dev/ctest.log build/dev
python3 tests/slowest_steps.py build
