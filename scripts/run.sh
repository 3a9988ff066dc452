#!/usr/bin/env bash
# From a fresh clone to a pack: installs what is missing, builds, runs on all cores.
# usage: [NP=ranks] scripts/run.sh INPUT.toml [options of packmpi]
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
[[ $# -gt 0 ]] || { sed -n '2,3s/^# //p' "$0" >&2; exit 2; }
say() { echo "run: $*" >&2; }
start=$SECONDS
"$here/setup.sh"
program=${BUILD:-$(dirname "$here")/build}/packmpi
if [[ -e $program ]]; then
  say "bringing $program up to date"
else
  say "building $program, once: five to six minutes on two cores"
fi
"$here/build.sh"
"$here/python_path.sh"
say "ready after $((SECONDS - start)) s; packmpi on ${NP:-$(nproc)} ranks"
source "$here/mpi_env.sh"
exec mpirun -n "${NP:-$(nproc)}" "$program" "$@"
