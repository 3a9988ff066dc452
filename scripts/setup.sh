#!/usr/bin/env bash
# Installs the Debian packages that are missing; says nothing and takes no time when none is.
# usage: scripts/setup.sh [--plots] [--render] [--site] [--checks] [--peers] [--readers] [--report] [--notebooks] [--fuzz] [--valgrind]
#   --plots   also h5py and matplotlib, for the scripts that read packs
#   --peers   also LAMMPS and LIGGGHTS, to compare with
#   --readers also LAMMPS, LIGGGHTS, YADE and VTK, which read packs that were converted for them
#   --render  also VTK and a virtual display, for pictures of packs in 3D
#   --report  also what --render brings, and Chromium, in which the test of packmpi report reads its page
#   --notebooks also what runs Jupyter's notebooks, of doc/notebooks
#   --site    also MkDocs and MathJax, for the documentation as a site
#   --checks  also clang-tidy, clang-format and mypy, for scripts/dev/check.sh
#   --fuzz    also clang with libFuzzer, for scripts/dev/fuzz.sh
#   --valgrind also valgrind, for scripts/dev/valgrind.sh
set -euo pipefail

packages=(g++ cmake ninja-build pkg-config git openmpi-bin libopenmpi-dev libpetsc-real-dev libeigen3-dev
  libhdf5-openmpi-dev libmetis-dev voro++-dev libboost-dev libgtest-dev libgmock-dev libtomlplusplus-dev libcli11-dev libfmt-dev
  libspdlog-dev librandom123-dev nlohmann-json3-dev pybind11-dev python3 python3-dev python3-numpy python3-h5py)
for option in "$@"; do
  case $option in
    --plots) packages+=(python3 python3-h5py python3-matplotlib python3-jsonschema) ;;
    --peers) packages+=(python3 python3-numpy python3-scipy python3-h5py lammps liggghts) ;;
    --readers) packages+=(python3 python3-h5py python3-vtk9 lammps liggghts yade) ;;
    --render) packages+=(python3 python3-h5py python3-matplotlib python3-vtk9 xvfb xauth) ;;
    --report) packages+=(python3 python3-h5py python3-matplotlib python3-vtk9 xvfb xauth chromium fonts-dejavu-core) ;;
    --notebooks) packages+=(python3-nbclient python3-nbformat python3-ipykernel python3-matplotlib) ;;
    --site) packages+=(mkdocs mkdocs-material python3-pymdownx libjs-mathjax) ;;
    --checks) packages+=(clang clang-tidy clang-format mypy python3 python3-numpy) ;;
    --fuzz) packages+=(clang libclang-rt-14-dev llvm) ;;
    --valgrind) packages+=(valgrind) ;;
    *) sed -n '2,13s/^# //p' "$0" >&2; exit 2 ;;
  esac
done

if ! command -v apt-get >/dev/null; then
  echo "setup: no apt-get here; these Debian packages, or what they hold, are needed: ${packages[*]}" >&2
  exit 0   # on a cluster the modules may be loaded already: let CMake judge
fi

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null || true)
  [[ $status == "install ok installed" ]] || missing+=("$package")
done
[[ ${#missing[@]} -eq 0 ]] && exit 0

as_root=()
if [[ $(id -u) -ne 0 ]]; then
  command -v sudo >/dev/null || { echo "setup: ask your administrator to install: ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
echo "setup: installing ${#missing[@]} Debian packages and what they need, a minute or so: ${missing[*]}"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
apt() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -y -qq -o DPkg::Lock::Timeout=300 "$@" >"$log" 2>&1 ||
    { cat "$log" >&2; echo "setup: apt-get $1 failed" >&2; exit 1; }
}
apt update
apt install --no-install-recommends "${missing[@]}"
