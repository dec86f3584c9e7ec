#!/bin/sh
# clang-tidy with .clang-tidy over core, io and app: sh tests/tidy.sh [--quick] [FILE...]
# The static analyzer takes three quarters of the time: --quick leaves it out.
set -eu
cd "$(dirname "$0")/.."
. tests/phases.sh

checks=
if [ "${1-}" = --quick ]; then
  checks=--checks=-clang-analyzer-*
  shift
fi
sh app/install_packages.sh --tidy
cmake --preset dev -B build/tidy -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DRAYCONE_UNITY=OFF >/dev/null
[ $# -gt 0 ] || set -- $(find core io app -name '*.cpp' | sort)

# tidy FILE: notes in build/tidy.tsv how long it took. The headers behind all others: <quadmath.h> is GCC's own.
rm -f build/tidy.tsv
export checks gcc_headers="$(g++ -print-file-name=include)"
tidy_all() {
  printf '%s\n' "$@" | xargs -P "$(nproc)" -n 1 sh -c '
    begin=$(date +%s)
    clang-tidy --quiet -p build/tidy $checks --extra-arg=-Wno-unknown-warning-option --extra-arg=-idirafter \
      --extra-arg="$gcc_headers" "$1" || exit 1
    printf "%s\t%s\n" "$(($(date +%s) - begin))" "$1" >>build/tidy.tsv' tidy
}
phase "clang-tidy${checks:+ without the analyzer}" tidy_all "$@"
