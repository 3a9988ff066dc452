#!/usr/bin/env bash
# Installs what is missing, builds everything, runs all tests.
# usage: [BUILD=folder] scripts/test.sh [options of ctest]     (for example -R rooms)
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
"$here/setup.sh" --plots --site
"$here/build.sh" all
# Twice as many at a time as there are cores: programs of a second that start MPI spend half of it waiting.
ctest --test-dir "${BUILD:-$here/../build}" --output-on-failure --no-tests=error -j "$((2 * $(nproc)))" "$@"
