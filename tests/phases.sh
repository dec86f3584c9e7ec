# To be sourced: phase NAME COMMAND... runs the command and notes in build/phases.tsv how long it took, for
# tests/slowest_steps.py.
phase() {
  phase_name=$1
  shift
  phase_begin=$(date +%s)
  "$@"
  mkdir -p build
  printf '%s\t%s\n' "$(($(date +%s) - phase_begin))" "$phase_name" >>build/phases.tsv
}
