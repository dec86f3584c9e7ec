#!/bin/sh
# tests/check_skipped.sh fails where a test was skipped, disabled or not run for no known reason, and only there:
#   sh tests/check_skipped_test.sh BUILD-DIRECTORY
set -eu
check=$(dirname "$0")/check_skipped.sh
build=$1
log=$(mktemp)
trap 'rm -f "$log"' EXIT

# fails_on WHAT MESSAGE: the check of the log.
fails_on() {
  if output=$(sh "$check" "$log" "$build" 2>&1); then
    echo "not noticed: $1" >&2
    exit 1
  fi
  case $output in
    *"$2"*) ;;
    *) echo "noticed, but not named: $output" >&2; exit 1 ;;
  esac
}

echo '100% tests passed, 0 tests failed out of 2' >"$log"
sh "$check" "$log" "$build"
for how in Skipped Disabled 'Not Run'; do
  # As ctest ends its log.
  printf 'The following tests did not run:\n\t  7 - Weld.Merges (%s)\n' "$how" >"$log"
  fails_on "$how" Weld.Merges
done
printf 'The following tests did not run:\n\t  7 - Weld.Merges [Skipped]\n' >"$log"
fails_on 'lines of another form' 'not understood'
: >"$log"
fails_on 'an empty log' 'no log'
rm "$log"
fails_on 'no log' 'no log'
