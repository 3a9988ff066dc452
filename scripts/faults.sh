#!/usr/bin/env bash
# Everything that was tried to break a run, counted: kills at random moments, restarts, damaged files, failing calls, the extremes.
# Writes doc/reliability.md's table. About a quarter of an hour.
# usage: [BUILD=folder] scripts/faults.sh [options of faults.py]      (for example -n 20)
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
"$here/setup.sh" --plots
"$here/build.sh" all
exec "$here/faults.py" --build "${BUILD:-$here/../build}" --tests --document "$here/../doc/reliability.md" "$@"
