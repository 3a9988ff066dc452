#!/usr/bin/env bash
# A small run on two ranks under valgrind, stopped half-way and gone on with: memory read before it was written, and
# what AddressSanitizer misses in the libraries below us. Errors end it with code 9. Leaks are left to AddressSanitizer:
# Open MPI's own would hide ours.
# usage: [BUILD=folder] scripts/dev/valgrind.sh
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
build=${BUILD:-$root/build}
source "$root/scripts/mpi_env.sh"
"$root/scripts/setup.sh" --valgrind
BUILD=$build "$root/scripts/build.sh"
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
supp=(--suppressions="$root/tests/support/valgrind.supp")
[[ -f /usr/share/openmpi/openmpi-valgrind.supp ]] && supp+=(--suppressions=/usr/share/openmpi/openmpi-valgrind.supp)
scene=("$root/input/quickstart.toml" -o "$out" --set "container.size=[0.2, 0.2, 0.1]" --set layers.thickness=0.1
  --set layers.fraction=0.2 --set layers.duration=0.01 --set output.contacts=true)
run() {   # the code expected, then options
  local expected=$1 code=0
  shift
  mpirun -n 2 valgrind -q --error-exitcode=9 --leak-check=no --log-file="$out/valgrind.%p" "${supp[@]}" \
    "$build/packmpi" "${scene[@]}" "$@" >"$out/words" 2>&1 || code=$?
  grep -h "^==" "$out"/valgrind.* >&2 || true
  [[ $code -eq $expected ]] || { cat "$out/words" >&2; echo "valgrind: exit code $code instead of $expected" >&2; exit 9; }
}
start=$SECONDS
run 75 --max-steps 30
run 0 --restart auto
echo "valgrind: 2 ranks, stopped and gone on with, no errors, $((SECONDS - start)) s"
