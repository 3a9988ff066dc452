#!/usr/bin/env bash
# Installs LAMMPS and LIGGGHTS, builds everything, and compares packmpi with them on the same scenes: scripts/compare.py.
# usage: scripts/compare.sh [options of compare.py]
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
"$here/setup.sh" --peers
"$here/build.sh" all
exec "$here/compare.py" --build "${BUILD:-$here/../build}" "$@"
