#!/bin/sh
# Load for minutes: sh tests/soak.sh [POINTS]
#   POINTS (default: ten million) through a pipe as text and as raw numbers, memory being constant from three seconds on;
#   ten thousand evaluators of small meshes in one process; four batches into one directory at once, ten times over.
# Needs the dev build. Prints what it saw; fails where memory grows or a test fails.
set -eu
cd "$(dirname "$0")/.."
points=${1:-10000000}
build=build/dev
allowed_kb=4096 # what the allocator keeps or not as it happens

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# resident PID: kilobytes now; nothing behind its end.
resident() {
  sed -n 's/^VmRSS:[[:space:]]*\([0-9]*\).*/\1/p' "/proc/$1/status" 2>/dev/null || true
}

# pipe_points NAME BYTES PRODUCER-COMMAND RAYCONE-OPTION...: a point of the answers has at least that many BYTES.
pipe_points() {
  name=$1 bytes=$2 producer=$3
  shift 3
  mkfifo "$work/in" "$work/out"
  sh -c "$producer" >"$work/in" &
  producer_pid=$!
  "$build/app/raycone" points data/meshes/swiss_roll.obj - "$@" --quiet <"$work/in" >"$work/out" &
  pid=$!
  wc -c <"$work/out" >"$work/bytes" &
  counter=$!
  first='' most=0 seconds=0
  while kill -0 "$pid" 2>/dev/null; do
    now=$(resident "$pid")
    [ -z "$first" ] && [ "$seconds" -ge 3 ] && first=$now
    [ "${now:-0}" -le "$most" ] || most=$now
    sleep 1
    seconds=$((seconds + 1))
  done
  wait "$producer_pid"
  wait "$pid"
  wait "$counter"
  echo "$name: $points points in $seconds s, $(cat "$work/bytes") bytes out; ${first:-0} kB after 3 s, at most $most kB"
  [ "$(cat "$work/bytes")" -ge $((points * bytes)) ] || { echo "soak: answers are missing" >&2; exit 1; }
  [ -n "$first" ] || { echo "soak: over in three seconds, expected more points" >&2; exit 1; }
  [ "$most" -le $((first + allowed_kb)) ] || { echo "soak: memory grew" >&2; exit 1; }
  rm "$work/in" "$work/out"
}

text="awk 'BEGIN { for (i = 0; i < $points; i++) printf \"%.6f,%.6f,%.6f\\n\", 3*rand()-1.5, 3*rand()-1.5, 3*rand() }'"
python3 -c 'import array, random, sys
random.seed(1)
array.array("d", (random.uniform(-1.5, 1.5) for _ in range(300000))).tofile(sys.stdout.buffer)' >"$work/block"
raw="for i in \$(seq $((points / 100000))); do cat '$work/block'; done"
pipe_points text 10 "$text"
pipe_points raw 8 "$raw" --raw f64

"$build/tests/raycone_tests" --gtest_brief=1 --gtest_filter='Soak.*'
"$build/tests/raycone_tests" --gtest_brief=1 --gtest_repeat=10 --gtest_filter='BatchInterruption.FourBatches*'
