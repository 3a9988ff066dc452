#!/usr/bin/env bash
# Builds the documentation as a site, build/site/index.html. A broken link and a page that is not on the site are errors.
# usage: scripts/dev/site.sh [folder]
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
"$root/scripts/setup.sh" --site
for page in "$root"/doc/*.md; do
  grep -q "\b$(basename "$page")$" "$root/scripts/dev/site.yml" || { echo "site: $(basename "$page") is not named in scripts/dev/site.yml" >&2; exit 1; }
done
mkdocs build --strict --quiet --clean -f "$root/scripts/dev/site.yml" -d "$(realpath -m "${1:-$root/build/site}")"
