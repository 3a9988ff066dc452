#!/usr/bin/env bash
# Installs what is missing, builds everything, runs all tests.
# usage: [BUILD=folder] scripts/test.sh [options of ctest]     (for example -R rooms)
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
"$here/setup.sh" --plots --site
"$here/build.sh" all
# Three times as many at a time as there are cores: programs of a second that start MPI spend half of it waiting, and tests of
# several ranks count as several (467 s where it was 524 with twice as many).
ctest --test-dir "${BUILD:-$here/../build}" --output-on-failure --no-tests=error -j "$((3 * $(nproc)))" "$@"
