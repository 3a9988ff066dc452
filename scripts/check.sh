#!/usr/bin/env bash
# The static checks: format of every source, clang-tidy over src/. Nothing is changed.
# usage: [BUILD=folder] scripts/check.sh [format|tidy]      (clang-format -i FILE mends the format)
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
source_dir=$(cd "$here/.." && pwd)
build=${BUILD:-$source_dir/build}
"$here/setup.sh" --checks

check_format() {
  find "$source_dir"/{src,include,tests} -name '*.[ch]pp' -print0 |
    xargs -0 clang-format --dry-run --Werror -ferror-limit=1 || { echo "check: clang-format found differences" >&2; return 1; }
}

# Reads the compile database: a configured build folder is enough, nothing need be built. A file's report is printed whole.
# Each file is read once, though the kernels are compiled six times: the builds differ in -march and dimension only.
check_tidy() {
  [[ -f $build/compile_commands.json ]] || BUILD=$build "$here/build.sh" packmpi_version_header
  mkdir -p "$build/tidy"
  python3 - "$build" <<'PYTHON'
import json, sys
entries = {entry["file"]: entry for entry in json.load(open(f"{sys.argv[1]}/compile_commands.json"))}
json.dump(list(entries.values()), open(f"{sys.argv[1]}/tidy/compile_commands.json", "w"))
PYTHON
  local one='out=$(clang-tidy -p "$0" --quiet "$1" 2>&1) || { printf "%s\n" "$out"; exit 1; }'
  find "$source_dir/src" -name '*.cpp' -printf '%s %p\n' | sort -rn | cut -d' ' -f2- |   # longest first
    { echo "$source_dir/src/dynamics/kernel_impl.cpp"; grep -v kernel_impl; } |           # its headers make it the longest
    xargs -d '\n' -P "$(nproc)" -n 1 bash -c "$one" "$build/tidy" || { echo "check: clang-tidy found something" >&2; return 1; }
}

[[ $# -gt 0 ]] || set -- format tidy
for check in "$@"; do "check_$check"; done
