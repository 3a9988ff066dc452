"""The interactive view inside the page of packmpi report: spheres to turn, to cut and to colour, drawn by the reader's own browser.

viewer.js is scripts/dev/viewer/viewer.js and three.js in one file (scripts/dev/viewer.sh makes it). Its data stand in the page, base64 of
little-endian float32: x, y, z, r of each sphere, in units of the container's largest extent, about its middle; and a value of each for
every field. Nothing is fetched.
"""
import base64
import hashlib
import html
import json
from pathlib import Path
from typing import Any

import numpy as np

from .pack import Floats, Pack
from .units import length_unit

SCRIPT = Path(__file__).parent / "viewer.js"
MOST = 300_000   # spheres in a page: 10 MB


def encoded(values: Any) -> str:
    """An array for the page."""
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode()


def fields_of(pack: Pack) -> list[tuple[dict[str, Any], Floats]]:
    """What spheres may be coloured by: name, unit, ends of the scale, and the values."""
    scale, unit = length_unit(float(pack.radius.max()))
    fields: list[tuple[str, str, Any]] = [("radius", unit, scale * pack.radius)] if np.ptp(pack.radius) > 0.0 else []
    if pack.components:
        fields.insert(0, ("component " + ", ".join(f"{k}: {name}" for k, name in enumerate(pack.components)), "", pack.component))
    fields += [("contacts", "", pack.contacts), ("layer of insertion", "", pack.layer + 1)]
    scale, unit = length_unit(float(pack.size[-1]))
    fields.append(("height", unit, scale * pack.position[:, 2]))
    if pack.pairs is not None and pack.forces is not None and len(pack.pairs) > 0:
        force = np.zeros(pack.count)
        strength = np.linalg.norm(pack.forces, axis=1)
        for end in (0, 1):
            np.maximum.at(force, pack.pairs[:, end], strength)
        fields.append(("largest contact force", "N", force))
    shown = []
    for name, unit, values in fields:
        values = np.asarray(values, dtype=float)
        high = float(np.quantile(values, 0.99)) if name == "largest contact force" else float(values.max())   # a few are far above all
        shown.append(({"name": name, "unit": unit, "low": float(values.min()), "high": high}, values))
    return shown


def script_source() -> str:
    """What the page's security policy has to allow: this script and no other."""
    return "'sha256-" + base64.b64encode(hashlib.sha256(SCRIPT.read_bytes()).digest()).decode() + "'"


def view(pack: Pack) -> str:
    """The view as a part of the page, or why there is none; nothing for discs."""
    if pack.dimension == 2:
        return ""
    if pack.count > MOST:
        return f'<p class="note">No interactive view: it takes {MOST} spheres at most; ParaView opens the pack itself.</p>'
    extent = float(max(pack.size.max(), pack.top()))
    size = np.array([pack.size[0], pack.size[1], pack.top()]) / extent
    spheres = np.column_stack([pack.position / extent - 0.5 * size, pack.radius / extent])
    order = np.random.default_rng(0).permutation(pack.count)   # so that a part of them is one of all
    fields = fields_of(pack)
    about = {"size": size.tolist(), "fields": [told for told, _ in fields]}
    data = [f'<script type="application/octet-stream" id="view-spheres">{encoded(spheres[order])}</script>']
    data += [f'<script type="application/octet-stream" id="view-field-{k}">{encoded(values[order])}</script>' for k, (_, values) in enumerate(fields)]
    words = html.escape(f"{pack.count} {pack.noun} in their container, to be turned and cut")
    return f"""<figure id="view"><canvas aria-label="{words}" tabindex="0"></canvas>
<p class="sorry note"></p>
<div class="controls">
<label>Colour <select class="field"></select></label>
<span class="scale"><span class="low"></span><span class="legend"></span><span class="high"></span></span>
<label>Cut along <select class="axis"><option value="+ x">x</option><option value="- y">y</option><option value="+ z">z</option></select></label>
<label class="cut">at <input type="range" min="0" max="1000" value="1000" aria-label="where the pack is cut"></label>
<button type="button">Reset</button>
</div>
<figcaption>Drag to turn; wheel or two fingers to zoom; right button or two fingers to move. A cut takes away what lies to its right (x), in front of it (y) or above it (z).</figcaption></figure>
<script type="application/json" id="view-about">{json.dumps(about)}</script>
{"".join(data)}
<script>{SCRIPT.read_text(encoding="utf-8")}</script>"""
