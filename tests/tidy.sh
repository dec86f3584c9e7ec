#!/bin/sh
# clang-tidy with .clang-tidy over core, io and app (apt-get install clang-tidy): sh tests/tidy.sh [FILE...]
# Takes some ten minutes on two cores.
set -eu
cd "$(dirname "$0")/.."

cmake --preset dev -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >/dev/null
[ $# -gt 0 ] || set -- core/*.cpp io/*.cpp app/*.cpp
printf '%s\n' "$@" | xargs -P "$(nproc)" -n 1 clang-tidy --quiet --extra-arg=-Wno-unknown-warning-option -p build/dev
