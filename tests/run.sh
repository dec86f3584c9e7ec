#!/bin/sh
# Installs what is missing, builds everything into build/dev and runs the tests: sh tests/run.sh [CTEST-OPTION...]
# Warnings are errors where RAYCONE_WERROR=ON is set in the environment.
set -eu
cd "$(dirname "$0")/.."

sh app/install_packages.sh --tests
cmake --preset dev -DRAYCONE_WERROR="${RAYCONE_WERROR:-OFF}"
cmake --build --preset dev --parallel "$(nproc)"
ctest --preset dev --parallel "$(nproc)" --output-log build/dev/ctest.log "$@"
sh tests/check_skipped.sh build/dev/ctest.log build/dev
