#!/bin/sh
# Fuzzes with clang: sh tests/fuzz/run.sh [--at-least SECONDS] [--quiet-for SECONDS] [TARGET...]
# Each target (default: all) for at least 1200 seconds and until it has reached no new edge for 300. What it finds stays
# in build/fuzz/corpus/TARGET, from which the next run goes on. Prints the row of docs/robustness.md; fails on a
# finding.
set -eu
cd "$(dirname "$0")/../.."

at_least=1200 quiet_for=300
while [ $# -gt 0 ]; do
  case $1 in
    --at-least) at_least=$2; shift 2 ;;
    --quiet-for) quiet_for=$2; shift 2 ;;
    -*) sed -n 2p "$0" >&2; exit 1 ;;
    *) break ;;
  esac
done
[ $# -gt 0 ] || set -- $(ls tests/fuzz/corpus)

fuzzer=
trap '[ -z "$fuzzer" ] || kill -INT "$fuzzer" 2>/dev/null || true' EXIT INT TERM

# latest KEY: the number behind it in the fuzzer's last line that has one.
latest() {
  sed -n "s/.*$1: *\([0-9]*\).*/\1/p" "$log" | tail -n 1
}

# Waits for the target's end, or for both times to have passed.
watch() {
  start=$(date +%s) progress=$(date +%s) edges=
  while kill -0 "$fuzzer" 2>/dev/null; do
    sleep 2
    now=$(date +%s)
    [ "$(latest cov)" = "$edges" ] || progress=$now
    edges=$(latest cov)
    if [ $((now - start)) -ge "$at_least" ] && [ $((now - progress)) -ge "$quiet_for" ]; then
      kill -INT "$fuzzer" 2>/dev/null || true
      break
    fi
  done
  wait "$fuzzer" || true
  fuzzer=
}

# Compressed data may ask for 2 GB to decode into, of which little is touched.
malloc_limit_mb=4096

# quiet COMMAND...: its last lines where it fails.
quiet() {
  "$@" >build/fuzz/build.log 2>&1 || { tail -n 30 build/fuzz/build.log >&2; exit 1; }
}

mkdir -p build/fuzz
quiet cmake --preset fuzz
status=0
for target in "$@"; do
  quiet cmake --build --preset fuzz --target "fuzz_$target"
  mkdir -p "build/fuzz/corpus/$target" "build/fuzz/findings"
  log=build/fuzz/$target.log
  build/fuzz/tests/fuzz/fuzz_"$target" -max_len=20000 -timeout=25 -print_final_stats=1 \
    -malloc_limit_mb=$malloc_limit_mb -artifact_prefix="build/fuzz/findings/$target-" \
    "build/fuzz/corpus/$target" "tests/fuzz/corpus/$target" >"$log" 2>&1 &
  fuzzer=$!
  watch
  executions=$(latest stat::number_of_executed_units)
  echo "| $target | $executions | $(($(date +%s) - start)) s | $edges | $(latest ft) |"
  if grep -q 'SUMMARY: ' "$log"; then
    grep -h 'SUMMARY: \|Test unit written' "$log" >&2
    status=1
  elif [ "${executions:-0}" -eq 0 ]; then  # it did not start
    tail -n 5 "$log" >&2
    status=1
  fi
done
exit "$status"
