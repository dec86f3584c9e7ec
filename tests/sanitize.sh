#!/bin/sh
# The tests that face hostile input and faults, under AddressSanitizer and UndefinedBehaviorSanitizer:
#   sh tests/sanitize.sh [CTEST-OPTION...]
# A part of the suite, so that it takes minutes; all of it: docs/developing.md, preset asan-ubsan.
set -eu
cd "$(dirname "$0")/.."

sh app/install_packages.sh --tests
cmake --preset asan-ubsan
cmake --build --preset asan-ubsan --parallel "$(nproc)" --target raycone replay
ctest --preset asan-ubsan --parallel "$(nproc)" -R '^(fuzz_corpus_.*|hostile_files|faults|vdb_module)$' "$@"
