#!/usr/bin/env bash
# The unit tests at 1 and 2 ranks, and the system tests labelled "sanitize", under AddressSanitizer and
# UndefinedBehaviorSanitizer, in build-sanitizers. About ten minutes on two cores.
# usage: [BUILD=folder] scripts/dev/sanitize.sh [options of ctest]
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
build=${BUILD:-$root/build-sanitizers}
"$root/scripts/setup.sh"
[[ -f $build/build.ninja ]] ||
  cmake -S "$root" -B "$build" --preset sanitizers --log-level=WARNING >/dev/null
BUILD=$build "$root/scripts/build.sh" all
run=(ctest --test-dir "$build" --output-on-failure -j "$(nproc)")
"${run[@]}" --no-tests=error -L '^np[12]$' -LE '^(system|slow)$' "$@"
"${run[@]}" -L '^sanitize$' "$@"
