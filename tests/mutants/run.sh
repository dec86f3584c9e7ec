#!/bin/sh
# Breaks each exactness rule of the core in turn; a test must fail for each: sh tests/mutants/run.sh [NAME...]
# With names, only those mutants of mutants.py. Exit status 1 if one survives, or if the core itself fails.
set -eu
exec python3 -B "$(dirname "$0")/check_mutants.py" "$@"
