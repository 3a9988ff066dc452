#!/usr/bin/env bash
# Builds the documentation as a site, build/site/index.html. A broken link and a page that is not on the site are errors.
# usage: scripts/site.sh [folder]
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
"$here/setup.sh" --site
for page in "$here"/../doc/*.md; do
  grep -q "\b$(basename "$page")$" "$here/site.yml" || { echo "site: $(basename "$page") is not named in scripts/site.yml" >&2; exit 1; }
done
mkdocs build --strict --quiet --clean -f "$here/site.yml" -d "$(realpath -m "${1:-$here/../build/site}")"
