#!/bin/sh
# clang-tidy with .clang-tidy over core, io and app: sh tests/tidy.sh [FILE...]
# Takes some five minutes on two cores.
set -eu
cd "$(dirname "$0")/.."

sh app/install_packages.sh --tidy
cmake --preset dev -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >/dev/null
[ $# -gt 0 ] || set -- $(find core io app -name '*.cpp' | sort)
# The headers behind all others: <quadmath.h> is GCC's own.
printf '%s\n' "$@" | xargs -P "$(nproc)" -n 1 clang-tidy --quiet -p build/dev \
  --extra-arg=-Wno-unknown-warning-option --extra-arg=-idirafter --extra-arg="$(g++ -print-file-name=include)"
