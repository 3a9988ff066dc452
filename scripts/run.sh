#!/usr/bin/env bash
# From a fresh clone to a pack: installs what is missing, builds, runs on all cores.
# usage: [NP=ranks] scripts/run.sh INPUT.toml [options of packmpi]
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
[[ $# -gt 0 ]] || { sed -n '2,3s/^# //p' "$0" >&2; exit 2; }
"$here/setup.sh"
"$here/build.sh"
source "$here/mpi_env.sh"
exec mpirun -n "${NP:-$(nproc)}" "${BUILD:-$here/../build}/packmpi" "$@"
