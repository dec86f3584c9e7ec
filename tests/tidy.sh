#!/bin/sh
# clang-tidy with .clang-tidy over core, io and app: sh tests/tidy.sh [--quick] [FOLDER... | FILE...]
# The static analyzer takes three quarters of the time: --quick leaves it out. A FOLDER's sources are checked as
# RAYCONE_UNITY compiles them, together, so that their headers are read once; a FILE is checked alone.
set -eu
cd "$(dirname "$0")/.."
. tests/phases.sh

phase_name='clang-tidy'
checks=
if [ "${1-}" = --quick ]; then
  phase_name='clang-tidy without the analyzer'
  checks=-clang-analyzer-*
  shift
fi
[ $# -gt 0 ] || set -- core io app
unity=OFF
warnings=
if [ -d "$1" ]; then
  unity=ON
  checks=$checks,-bugprone-suspicious-include  # of .cpp files: how they are put together
  warnings=--extra-arg=-Wno-shadow             # of one file's constants by another's
fi
sh app/install_packages.sh --tidy
cmake --preset dev -B build/tidy -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DRAYCONE_UNITY=$unity >/dev/null
[ $unity = OFF ] || set -- $(python3 -c '
import json, os, sys
for command in json.load(open("build/tidy/compile_commands.json")):
    file = os.path.relpath(command["file"])
    if file.removeprefix("build/tidy/").startswith(tuple(folder + "/" for folder in sys.argv[1:])):
        print(file)' "$@")

# tidy_all FILE...: notes in build/tidy.tsv how long each took. The headers behind all others: <quadmath.h> is GCC's
# own.
rm -f build/tidy.tsv
export checks warnings gcc_headers="$(g++ -print-file-name=include)"
tidy_all() {
  printf '%s\n' "$@" | xargs -P "$(nproc)" -n 1 sh -c '
    begin=$(date +%s)
    clang-tidy --quiet -p build/tidy --checks="$checks" --extra-arg=-Wno-unknown-warning-option \
      --extra-arg=-idirafter --extra-arg="$gcc_headers" $warnings "$1" || exit 1
    printf "%s\t%s\n" "$(($(date +%s) - begin))" "$1" >>build/tidy.tsv' tidy
}
phase "$phase_name" tidy_all "$@"
