#!/bin/sh
# The executable under sanitizers, behind tests/run.sh: sh tests/sanitize.sh [asan-ubsan] [tsan]
# Without arguments both; continuous integration takes the first alone.
# The dev build's black-box tests drive an executable built with AddressSanitizer and UndefinedBehaviorSanitizer, and
# one with ThreadSanitizer, so that the tests need not be compiled again; the former also takes the fuzz corpora, the
# hostile files, the faults, the random command lines, the damaged meshes and solids that are cut. The whole suite under
# sanitizers takes an hour: docs/developing.md.
set -eu
cd "$(dirname "$0")/.."
. tests/phases.sh
jobs=$(nproc)
test_jobs=$((jobs + 1))  # tests wait for disks and for each other

# Suites whose tests start the executable. BatchCost compares it with its own process.
suites=$(grep -lE 'run_raycone|raycone_command|batch_fixture' tests/app/*_test.cpp tests/app/batch/*_test.cpp |
  xargs sed -nE 's/^TEST(_F)?\((\w+),.*/\2/p' | sort -u | grep -vx BatchCost | paste -sd '|')

# What is about so little memory that sanitizers have none left.
of_memory='MemoryLimitsHoldForThoseThatLookForBuffers|AWorkerIsChargedForOpenVdbOnce'

# What does the same over and over, with other threads or moments.
of_bytes='BytesDepend|SamplesDependOnTheJobAlone|KilledAtAnyMoment'

# What starts batches again and again: with AddressSanitizer a worker takes a quarter of a second to start, and reads
# and writes what other batches do.
of_state='^(Batch|BatchInterruption|BatchStale|BatchPrune)\.'

# black_box PRESET CTEST-OPTION...: the dev build's tests of what PRESET built.
black_box() {
  preset=$1
  shift
  export RAYCONE_TEST_EXECUTABLE="$PWD/build/$preset/app/raycone"
  phase "test $preset: the tool" \
    ctest --preset dev --parallel "$test_jobs" --output-log "build/$preset/ctest.log" -R "^($suites)\." "$@"
  sh tests/check_skipped.sh "build/$preset/ctest.log" "build/$preset"
  unset RAYCONE_TEST_EXECUTABLE
}

sh app/install_packages.sh --tests
phase "build dev" cmake --build --preset dev --parallel "$jobs" --target raycone_tests raycone_vdb_tests

# GCC 12's sanitizers take a loaded module's thread-local storage for that of an older C library where it happens to
# begin 16 bytes behind a page's start, and die of the addresses that they read there: they need not look.
tls=intercept_tls_get_addr=0

asan_ubsan() {
  export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
  cmake --preset asan-ubsan
  phase "build asan-ubsan" cmake --build --preset asan-ubsan --parallel "$jobs" --target raycone manual replay
  # Not: what watches the threads of unoptimised code, or memory; and what asks for SIMD levels that this build leaves
  # out; and what compares the bytes of many runs, which do nothing that other tests do not. Leaks are looked for below,
  # by fuzz corpora and where disks are full: it doubles the time of a short run.
  export ASAN_OPTIONS=$tls:detect_leaks=0
  black_box asan-ubsan -E "$of_state|NeverMoreThreadsAreBusyThanAllowed|$of_memory|$of_bytes|Engines\.AgreeOn"
  export ASAN_OPTIONS=$tls
  phase 'test asan-ubsan: files and faults' \
    ctest --preset asan-ubsan --parallel "$test_jobs" --output-log build/asan-ubsan/ctest-files.log \
    -R '^(fuzz_corpus_.*|hostile_files|damaged_vdb|faults|full_disk|command_lines|damaged_meshes|cut_solids|vdb_module)$'
  sh tests/check_skipped.sh build/asan-ubsan/ctest-files.log build/asan-ubsan
}

tsan() {
  export TSAN_OPTIONS=$tls:suppressions=$PWD/tests/tsan.supp
  cmake --preset tsan
  phase "build tsan" cmake --build --preset tsan --parallel "$jobs" --target raycone
  # Not: what ends before a thread begins; what counts the threads of core/machine/threads.cpp, which this build
  # replaces; what watches memory; and what asks for SIMD levels that it leaves out.
  early='^(CommandLine|Depfile|DepfileText|Formats|InfoCommand|InfoGate)\.'
  black_box tsan -E "$early|NeverMoreThreadsAreBusyThanAllowed|$of_memory|Engines\.AgreeOn"
}

[ $# -gt 0 ] || set -- asan-ubsan tsan
for name; do
  case $name in
    asan-ubsan) asan_ubsan ;;
    tsan) tsan ;;
    *) echo "sanitize.sh: expected asan-ubsan or tsan, found '$name'" >&2; exit 2 ;;
  esac
done
