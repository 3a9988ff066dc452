#!/usr/bin/env bash
# Builds the documentation as a site, build/site/index.html. A broken link, also of README, a page that is not on the site or not in
# its index, and a formula whose asterisks were taken for emphasis are errors.
# usage: scripts/dev/site.sh [folder]
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
"$root/scripts/setup.sh" --site
for page in "$root"/doc/*.md; do
  grep -q "\b$(basename "$page")$" "$root/scripts/dev/site.yml" || { echo "site: $(basename "$page") is not named in scripts/dev/site.yml" >&2; exit 1; }
  [[ $page == */index.md ]] || grep -qF "($(basename "$page"))" "$root/doc/index.md" || { echo "site: doc/index.md leads nowhere to $(basename "$page")" >&2; exit 1; }
done
for page in $(grep -oE '\]\(doc/[^)#]*' "$root/README.md" | cut -c3-); do   # mkdocs checks those of doc/
  [[ -e $root/$page ]] || { echo "site: README.md leads to $page, which is not there" >&2; exit 1; }
done
built=$(realpath -m "${1:-$root/build/site}")
mkdocs build --strict --quiet --clean -f "$root/scripts/dev/site.yml" -d "$built"
# MathJax beside the pages, the part of it that they use: nothing is fetched, from the disk either.
mathjax=/usr/share/javascript/mathjax
for part in MathJax.js config/TeX-AMS_SVG.js extensions jax/element jax/input/TeX jax/output/SVG/{autoload,config.js,jax.js,fonts/TeX}; do
  mkdir -p "$built/mathjax/$(dirname "$part")"
  cp -rL "$mathjax/$part" "$built/mathjax/$part"
done
# The theme's index again, for pages from the disk (scripts/dev/site/main.html): a script may be read there, JSON may not.
python3 -c 'import json, sys; json.dump(json.load(open(sys.argv[1]))["docs"], sys.stdout)' "$built/search/search_index.json" |
  { printf 'window.indexOfDisk = '; cat; } >"$built/search/index_of_disk.js"
# "r* = r_i, m* = m_i" must stand between backticks: Markdown would take the asterisks away.
if grep -noE '[[:alnum:]]<em>|<em> |<em>[^<]*[=^][^<]*</em>' "$built"/*.html; then
  echo "site: asterisks of a formula were taken for emphasis; put it between backticks" >&2
  exit 1
fi
