#!/usr/bin/env bash
# Everything that was tried to break a run, counted: kills at random moments, restarts, damaged files, failing calls, the extremes.
# Writes doc/reliability.md's table. About a quarter of an hour.
# usage: [BUILD=folder] scripts/dev/faults.sh [options of faults.py]      (for example -n 20)
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
"$root/scripts/setup.sh" --plots
"$root/scripts/build.sh" all
exec "$root/scripts/dev/faults.py" --build "${BUILD:-$root/build}" --tests --document "$root/doc/reliability.md" "$@"
