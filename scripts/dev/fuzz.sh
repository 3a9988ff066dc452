#!/usr/bin/env bash
# The readers of scenes, of meshes, of checkpoints and packs, and of other programs' particles, given what nobody would write:
# the fuzzers of tests/fuzz side by side, a core each. What is new in their corpora stays in BUILD/corpus for the next time.
# usage: [BUILD=folder] scripts/dev/fuzz.sh [seconds]     (60; folder build-fuzz)
# Exit code 1 if anything was found: the bytes are in BUILD/findings, what happened in BUILD/NAME.log, and
# BUILD/fuzz_NAME FILE does it again.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
tests=$root/tests
build=${BUILD:-$root/build-fuzz}
seconds=${1:-60}
source "$root/scripts/mpi_env.sh"
"$root/scripts/setup.sh" --fuzz
[[ -f $build/build.ninja ]] || cmake -S "$root" -B "$build" --preset fuzz --log-level=WARNING >/dev/null
BUILD=$build "$root/scripts/build.sh" packmpi_fuzzers

# A file is written for every trial, but of scenes: to memory, if there is a place.
memory=/tmp
[[ -w /dev/shm ]] && memory=/dev/shm
work=$(mktemp -d "$memory/packmpi-fuzz-XXXXXX")
trap 'rm -rf "$work"' EXIT
mkdir -p "$build/findings"
grep -oh '"[A-Za-z_][A-Za-z0-9_.]*"' "$root"/src/input/{keys,key_words}.* "$root"/src/config/words.* "$root"/src/tables/units.* | sort -u >"$build/input.dict"

# The timeout is for what waits for ever; the fuzzers themselves allow each trial a second of the processor.
fuzz() {   # name, options and folders of seeds
  local name=$1 log=$build/$1.log start=$EPOCHREALTIME code=0 runs
  shift
  mkdir -p "$build/corpus/$name"
  TMPDIR=$work "$build/fuzz_$name" -max_total_time="$seconds" -timeout=120 -report_slow_units=120 -print_final_stats=1 \
    -artifact_prefix="$build/findings/$name-" "$build/corpus/$name" "$tests/fuzz/corpus/$name" "$@" >"$log" 2>&1 || code=$?
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  awk -v name="$name" -v runs="${runs:-0}" -v s="$start" -v e="$EPOCHREALTIME" -v code="$code" 'BEGIN {
    printf "fuzz: %s: %d executions in %.0f s, %s\n", name, runs, e - s, code == 0 ? "nothing found" : "FOUND something" }'
  [[ $code -eq 0 ]] || { grep -E '^fuzz: |^SUMMARY|ERROR|Test unit' "$log" | sed "s|^|fuzz: $name: |" >&2; return 1; }
}
fuzz input -max_len=4096 -dict="$build/input.dict" "$root/input" "$tests/input/bad" &
input=$!
# Leaks of MPI, which lives as long as the fuzzer, are no findings; the unit tests look for ours.
ASAN_OPTIONS=detect_leaks=0 fuzz checkpoint -max_len=256 -len_control=0 -detect_leaks=0 &
checkpoint=$!
fuzz rows -max_len=2048 &
rows=$!
fuzz mesh -max_len=2048 &
mesh=$!
failed=0
wait "$input" || failed=1
wait "$rows" || failed=1
wait "$checkpoint" || failed=1
wait "$mesh" || failed=1
exit "$failed"
