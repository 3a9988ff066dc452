#!/usr/bin/env bash
# The unit tests at 1 and 2 ranks, and the system tests labelled "sanitize", under AddressSanitizer and
# UndefinedBehaviorSanitizer, in build-sanitizers. About ten minutes; --quick, half of that: of the unit tests those at
# 2 ranks of the rooms where particles and messages are handled.
# usage: [BUILD=folder] scripts/sanitize.sh [--quick] [options of ctest]
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
build=${BUILD:-$here/../build-sanitizers}
rooms=(comm particles scene rsa neighbor dynamics observe)
targets=(all)
unit=(-L '^np[12]$')
if [[ ${1:-} == --quick ]]; then
  shift
  targets=(packmpi_program)
  for room in "${rooms[@]}"; do targets+=("tests/$room/all"); done
  unit=(-L '^np2$' -R "^($(IFS='|'; echo "${rooms[*]}"))/")
fi
"$here/setup.sh"
[[ -f $build/build.ninja ]] ||
  cmake -S "$here/.." -B "$build" --preset sanitizers --log-level=WARNING >/dev/null
BUILD=$build "$here/build.sh" "${targets[@]}"
run=(ctest --test-dir "$build" --output-on-failure -j "$(nproc)")
"${run[@]}" --no-tests=error "${unit[@]}" -LE '^(system|slow)$' "$@"
"${run[@]}" --no-tests=error -L '^sanitize$' "$@"
