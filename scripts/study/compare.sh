#!/usr/bin/env bash
# Installs LAMMPS and LIGGGHTS, builds everything, and compares packmpi with them on the same scenes: scripts/study/compare.py.
# usage: scripts/study/compare.sh [options of compare.py]
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
"$root/scripts/setup.sh" --peers
"$root/scripts/build.sh" all
exec "$root/scripts/study/compare.py" --build "${BUILD:-$root/build}" "$@"
