#!/usr/bin/env bash
# Makes scripts/python/packmpi/viewer.js, the interactive view of packmpi report: viewer/viewer.js and three.js in one file, with its licence.
# Needs npm and the network; the result is kept in the repository, so only who changes the view runs this.
# usage: scripts/dev/viewer.sh [folder to work in]
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
work=${1:-$(mktemp -d)}
mkdir -p "$work"
cp "$here"/viewer/{package.json,viewer.js} "$work"
cd "$work"
npm install --no-audit --no-fund --silent
licence=$(sed 's/^/ * /; s/ *$//' node_modules/three/LICENSE)
node_modules/.bin/esbuild viewer.js --bundle --minify --format=iife --target=es2020 --legal-comments=none \
  --banner:js="/* three.js $(node -p 'JSON.parse(require("fs").readFileSync("node_modules/three/package.json")).version'), https://threejs.org
$licence
 */" --outfile="$here/../python/packmpi/viewer.js" --log-level=warning
! grep -q '</script' "$here/../python/packmpi/viewer.js"   # it stands inside a page
