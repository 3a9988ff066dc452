#!/usr/bin/env bash
# Lets Debian's python3 find packmpi, as it was built: one line in a file of the user's own site-packages. No root, no pip (which Debian
# keeps for virtual environments); in a virtual environment say PYTHONPATH=build/python instead. Says so when the line is new.
# usage: [BUILD=folder] scripts/python_path.sh [--remove]        (PACKMPI_PTH=no: does nothing)
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
package=$(realpath -m "${BUILD:-$here/../build}/python")
python=/usr/bin/python3
[[ ${PACKMPI_PTH:-yes} != no && -x $python ]] || exit 0
[[ $("$python" -c 'import site; print(site.ENABLE_USER_SITE)') == True ]] || exit 0   # switched off: PYTHONNOUSERSITE
file=$("$python" -c 'import site; print(site.getusersitepackages())')/packmpi.pth
if [[ ${1:-} == --remove ]]; then
  rm -f "$file"
elif compgen -G "$package/packmpi/_core.*.so" >/dev/null && [[ $(cat "$file" 2>/dev/null) != "$package" ]]; then
  if mkdir -p "$(dirname "$file")" 2>/dev/null && echo "$package" 2>/dev/null >"$file"; then
    echo "run: python3 can import packmpi now ($file)" >&2
  else
    echo "run: $file cannot be written: import packmpi by PYTHONPATH=$package" >&2
  fi
fi
