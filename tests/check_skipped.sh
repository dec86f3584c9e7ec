#!/bin/sh
# Fails where a test was skipped without one of the reasons known here:
#   sh tests/check_skipped.sh CTEST-LOG BUILD-DIRECTORY
# A test that finds its data or its tools missing would otherwise pass for ever.
set -eu
log=$1
build=$2

# setting NAME: its value in the build's cache.
setting() {
  sed -n "s/^$1:[A-Z]*=//p" "$build/CMakeCache.txt"
}

allowed='^$'
allow() {
  allowed="$allowed|^($1)\$"
}
# Permissions do not bind root, as whom containers run.
[ "$(id -u)" -ne 0 ] || \
  allow 'OutputFile\.RefusesADirectoryWithoutPermission|BatchMeshes\.ADirectoryThatCannotBeReadStandsForWhatItHolds'
# The shared meshes lie beside the repository, not in it.
[ -f "$(setting RAYCONE_SHARED_MESHES)/MANIFEST.csv" ] || allow "shared_meshes|accuracy_of_real_meshes|distance_signs|labels|mesh_warnings|$(cat <<'END'
SharedMeshes\..*|SharedIntersections\..*|ReadGltf\.SharedMeshes.*|RuleBlocks\.HoldOnRealOpenMeshes
END
)"
# Only root may become another user.
[ "$(id -u)" -eq 0 ] || allow 'faults_threads'
# Sanitizers reserve terabytes of addresses, and die where memory runs out.
[ -z "$(setting RAYCONE_SANITIZE)" ] || allow 'faults_memory|faults_threads|ulimit'
# They must be loaded before libfaketime, and trace themselves.
[ -z "$(setting RAYCONE_SANITIZE)" ] || allow 'clock|system_calls'
# Containers may forbid to trace.
strace -o /dev/null true 2>/dev/null || allow 'system_calls'
# ThreadSanitizer has a thread of its own, and core/machine/threads.h another implementation.
[ "$(setting RAYCONE_SANITIZE)" != thread ] || allow 'BatchInterruption\.NeverMoreThreadsAreBusyThanAllowed'
# Containers may forbid file systems of one's own; it is mounted in a namespace that ends at once.
unshare --user --map-root-user --mount mount -t tmpfs tmpfs "$build" 2>/dev/null || allow 'full_disk'
# Programs too large for continuous integration; tests/clients.sh installs the clients.
command -v blender >/dev/null || allow 'clients_blender'
command -v chromium >/dev/null || allow 'report_page'
[ -d /usr/lib/python3/dist-packages/paraview ] || allow 'clients_paraview'

if ! [ -s "$log" ]; then
  echo "check_skipped: $log: no log" >&2
  exit 1
fi
skipped=$(sed -n 's/^[[:space:]]*[0-9]* - \(.*\) (\(Skipped\|Disabled\|Not Run\))$/\1/p' "$log")
if [ -z "$skipped" ] && grep -q '^The following tests did not run:' "$log"; then
  echo "check_skipped: $log: tests did not run, but their lines are not understood" >&2
  exit 1
fi
status=0
for test in $skipped; do
  if ! echo "$test" | grep -qE "$allowed"; then
    echo "check_skipped: $test was skipped; tests/check_skipped.sh knows no reason for that" >&2
    status=1
  fi
done
exit "$status"
