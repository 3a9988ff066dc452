#!/usr/bin/env bash
# Builds the program, build/packmpi, and the Python package, build/python.
# usage: [BUILD=folder] [PACKMPI_CMAKE="option ..."] scripts/build.sh [target ...]      ("all" for the tests and benchmarks too)
set -euo pipefail
source_dir=$(cd "$(dirname "$0")/.." && pwd)
build=${BUILD:-$source_dir/build}

if [[ ! -f $build/build.ninja ]]; then
  cmake -S "$source_dir" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release ${PACKMPI_CMAKE:-} --log-level=WARNING >/dev/null
fi
targets=("$@")
[[ $# -gt 0 ]] || targets=(packmpi_program packmpi_python)
quiet=()
[[ -t 1 ]] || quiet=(-- --quiet)   # a bar on a terminal; in a log only what went wrong
cmake --build "$build" --target "${targets[@]}" "${quiet[@]}"
