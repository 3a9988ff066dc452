#!/usr/bin/env bash
# The static checks: format of every source, clang-tidy over src/, types of the Python package. Nothing is changed.
# usage: [BUILD=folder] scripts/dev/check.sh [format|tidy|types]      (clang-format -i FILE mends the format)
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
build=${BUILD:-$root/build}
"$root/scripts/setup.sh" --checks

check_format() {
  find "$root"/{src,include,tests} -name '*.[ch]pp' -print0 |
    xargs -0 clang-format --dry-run --Werror -ferror-limit=1 || { echo "check: clang-format found differences" >&2; return 1; }
}

# In a folder of its own, configured and not built, where several sources are read at once: their common headers are most of the
# work (that sources are included there is no mistake). The analyser's checks of MPI are for src/comm alone, which calls it; they
# would double the time elsewhere. A report is printed whole. The kernels, compiled six times, are read once: the builds differ in
# -march and dimension only.
check_tidy() {
  local folder=$build/check
  cmake -S "$root" -B "$folder" -G Ninja -DCMAKE_UNITY_BUILD=ON -DPACKMPI_TESTS=OFF -DPACKMPI_BENCHMARKS=OFF \
    --log-level=WARNING >/dev/null
  BUILD=$folder "$root/scripts/build.sh" packmpi_version_header
  local one='out=$(clang-tidy -p "$0" --config-file="$1" --quiet ${3:+"$3"} "$2" 2>&1) || { printf "%s\n" "$out"; exit 1; }'
  local all=(xargs -d '\n' -P "$(nproc)" -I FILE bash -c "$one" "$folder/tidy" "$root/.clang-tidy" FILE)
  python3 - "$folder" <<'PYTHON' |
import json, os, sys
path = f"{sys.argv[1]}/compile_commands.json"
entries = {entry["file"]: entry for entry in json.load(open(path))}
for entry in entries.values():   # clang has no such option
    entry["command"] = entry["command"].replace(" -fno-tree-loop-distribute-patterns", "")
os.makedirs(f"{sys.argv[1]}/tidy", exist_ok=True)
json.dump(list(entries.values()), open(f"{sys.argv[1]}/tidy/compile_commands.json", "w"))
print("\n".join(sorted(entries, key=lambda file: "kernel_impl" not in file and "Unity" not in file)))   # the longest first
PYTHON
    "${all[@]}" --checks=-bugprone-suspicious-include &&
    find "$root/src/comm" -name '*.cpp' | "${all[@]}" '--checks=-*,clang-analyzer-optin.mpi*' ||
    { echo "check: clang-tidy found something" >&2; return 1; }
}

# What numpy, h5py and JSON give is of any type; of what has no types itself (h5py, matplotlib, VTK) nothing is known.
check_types() {
  mypy --strict --no-warn-return-any --ignore-missing-imports --python-version 3.11 --cache-dir="$build/check/mypy" \
    --no-error-summary "$root/scripts/python/packmpi" || { echo "check: mypy found something" >&2; return 1; }
}

[[ $# -gt 0 ]] || set -- format types tidy
for check in "$@"; do "check_$check"; done
