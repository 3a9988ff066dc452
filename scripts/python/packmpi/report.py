"""One page on a pack, for eyes and for an archive: NAME.html, pictures and plots inside, nothing fetched from elsewhere.

usage: packmpi report PACK.hdf [-o page.html] [--program packmpi] [--size pixels] [--crate LICENCE]

Facts, a view to turn and cut, pictures, plots, targets beside what was achieved, protocol, checks and provenance. A picture that cannot be drawn is left
out, and the page says why. The numbers are those of the pack and of `packmpi analyze`; the history is NAME.steps.csv.
"""
import argparse
import base64
import html
import tempfile
from pathlib import Path
from typing import Any, Optional, Sequence, Union

import numpy as np

from . import plot
from .crate import write_record
from .problem import Problem, named
from .pack import Pack
from .render import Colouring, container_size, pictures_of, use_few_colours
from .render_2d import draw_section
from .style import ACHIEVED, BACKGROUND, GRID, INK, OTHER, TARGET
from .units import length_unit
from .view import script_source, view

STYLE = Path(__file__).parent / "report.css"
# What a plot's colours become on a dark page.
DARK = {INK: "#d8dee4", GRID: "#333b43", TARGET: "#ff8a98", ACHIEVED: "#4fc3d4", OTHER: "#7d8b99"}


def number(value: Any, digits: int = 4) -> str:
    """A number for people: thousands apart, powers of ten beyond four places."""
    if value is None or (isinstance(value, float) and not np.isfinite(value)):
        return "–"
    if isinstance(value, (int, np.integer)):
        return f"{value:,}".replace(",", " ")
    if value != 0.0 and not 1e-3 <= abs(value) < 1e5:
        mantissa, power = f"{value:.{digits - 1}e}".split("e")
        if "." in mantissa:
            mantissa = mantissa.rstrip("0").rstrip(".")
        return f"{mantissa}&nbsp;×&nbsp;10<sup>{int(power)}</sup>".replace("-", "−")
    return f"{value:.{digits}g}".replace("-", "−")


def quantity(value: Any, unit: str = "", digits: int = 4) -> str:
    """A number and its unit, on one line."""
    return f"{number(value, digits)}&nbsp;{unit}" if unit else number(value, digits)


def percent(achieved: float, target: float) -> str:
    """The difference, of the target."""
    return f"{100.0 * (achieved / target - 1.0):+.2f}&nbsp;%".replace("-", "−") if target else "–"


def length(value: float, digits: int = 4) -> str:
    """A length [m] in a unit that suits it."""
    scale, unit = length_unit(value)
    return quantity(scale * value, unit, digits)


def table(heads: Sequence[str], rows: Sequence[Sequence[str]], label: str) -> str:
    """`rows` of ready HTML; the first cell of a row is its head. A row of one cell parts the table."""
    out = [f'<div class="wide"><table aria-label="{label}"><thead><tr>']
    out += [f"<th>{head}</th>" for head in heads] + ["</tr></thead><tbody>"]
    for row in rows:
        if len(row) == 1:
            out.append(f'<tr class="part"><th colspan="{len(heads)}">{row[0]}</th></tr>')
        else:
            out.append(f"<tr><th>{row[0]}</th>" + "".join(f"<td>{cell}</td>" for cell in row[1:]) + "</tr>")
    return "".join(out) + "</tbody></table></div>"


def listed(pairs: Sequence[tuple[str, str]]) -> str:
    """Names and values."""
    return "<dl>" + "".join(f"<div><dt>{name}</dt><dd>{value}</dd></div>" for name, value in pairs) + "</dl>"


def section(name: str, title: str, *parts: str) -> str:
    """A part of the page, with an anchor."""
    return f'<section id="{name}"><h2>{title}</h2>{"".join(part for part in parts if part)}</section>'


def inline(path: Path, kind: str, words: str) -> str:
    """An image as part of the page; `words` are for those who do not see it."""
    data = base64.b64encode(Path(path).read_bytes()).decode()
    return f'<img alt="{html.escape(words)}" src="data:image/{kind};base64,{data}">'


# --- what the page says ---

def facts(pack: Pack, analysis: dict[str, Any]) -> str:
    """The few numbers everybody looks for, large."""
    made = pack.summary
    tiles = [(number(pack.count), pack.noun), (f"{pack.phi_bulk:.4f}", "solid fraction of the bulk"),
             (f"{pack.porosity_bulk:.4f}", "porosity n of the bulk"),
             (number(pack.void_ratio_bulk if pack.phi_bulk else None), "void ratio e of the bulk"),
             (f"{made['coordination']:.2f}", "coordination number"),
             (length(made["height"]), f"high; target {length(pack.size[-1])}"),
             (f"{100.0 * analysis['contacts']['rattlers']:.1f} %", "rattlers"),
             (f"{0.001 * made['stress_on_lid']:.4g} kPa", "stress on the lid") if made.get("stress_on_lid") else
             (f"{pack.rest['support']:.3f}", "of the weight borne by the walls") if pack.shape == "mesh" and "support" in pack.rest else
             (f"{made['floor_force'] / made['weight']:.3f}" if made["weight"] else "–", "of the weight on the floor")]
    drawn = "".join(f'<div class="tile"><b>{value}</b><span>{words}</span></div>' for value, words in tiles)
    return f'<div class="tiles">{drawn}</div>'


def warning(pack: Pack) -> str:
    """What keeps the pack from being what was wanted, a paragraph each, or nothing."""
    words = []
    if not pack.summary["reached"] and by_height(pack):
        words.append(f'The pack is lower than its target: {length(pack.summary["height"])} of {length(pack.size[-1])}, stopped by '
                     f'{html.escape(pack.summary["stop_reason"])}. Solid fractions that count to the target height are too small.')
    words += [html.escape(line) for line in pack.rest.get("missed", "").splitlines() if not line.startswith(("container.size:", "container.height:"))]
    return "".join(f'<p class="warning" role="alert"><b class="bad">Missed:</b> {line}</p>' for line in words)


COLOURED = {"component": "Coloured by component", "radius": "Coloured by size", "layer": "Coloured by layer of insertion"}


def pictures(pack: Pack, folder: Path, pixels: int) -> str:
    """The pack from outside: components, sizes, or layers if they are equal; and contacts. Of spheres the section through the middle, too; discs
    with their force chains."""
    first = Colouring(pack).what
    words, notes = COLOURED[first], ""
    if pack.dimension == 2 and pack.pairs is not None:
        words += ", with force chains: lines as thick as the contact forces"
    elif pack.dimension == 2:
        notes = '<p class="note">No force chains: the pack was written without <code>output.contacts = true</code>.</p>'
    shown = {folder / f"picture.{first}.png": words, folder / "picture.contacts.png": "Coloured by the coordination number"}
    assert pack.path is not None   # of a pack that has a file
    wrong = pictures_of(pack.path, shown, "-o", folder / "picture.png", "--size", pixels, "--color", first, "contacts")
    if wrong:
        notes, shown = f'<p class="note">No pictures: {html.escape(wrong)}</p>', {}
    if pack.dimension == 3:
        path = folder / "picture.section.png"
        draw_section(pack, Colouring(pack), path, pixels)
        use_few_colours(path)
        shown[path] = f"The section through the middle: circles as the plane across y cuts the spheres. {COLOURED[first]}"
    drawn = "".join(f'<figure class="photo">{inline(path, "png", words)}<figcaption>{words}.</figcaption></figure>'
                    for path, words in shown.items())
    return f'<div class="pair">{drawn}</div>{notes}'


CAPTIONS = {
    "density": "Solid fraction over the height; shaded, the bulk: between 0.2 and 0.8 of the target height, or of a lid or a bed that is lower.",
    "composition": "What the solid is of, over the height.",
    "lateral": "Solid fraction of the bulk from one side to the other; flat walls order the nearest layers, and the profile swings there.",
    "radial": "Solid fraction by the distance from the wall, around which spheres stand in rings.",
    "segregation": "Mean radius over the height: level where sizes are not sorted by it. Steps beyond chance need many particles in a slab.",
    "sizes": "Target sizes (dashed) and achieved ones, as sieves would show them.",
    "pairs": "Pair distribution around particles away from walls; 1 where places do not know of each other.",
    "coordination": "How many others a particle touches; walls are not counted.",
    "forces": "Contact forces over their mean. Straight on this axis: an exponential, as in beds at rest.",
    "rose": "Where contacts point to: from the vertical, upward, weighed by the solid angle; a circle if all directions are alike.",
    "settling": "How the layers settled; energies are those of the particles that move."}

MISSING = {
    "density": "No density profile.", "composition": "One component.", "radial": "No radial profile.", "lateral": "No lateral profile.", "segregation": "All radii are equal, or the pack is too low: no profile of sizes.", "sizes": "All radii are equal: no size curves.",
    "pairs": "The pack is too small for a pair distribution.",
    "coordination": "No particle touches another.", "forces": "Too few contacts for a distribution of forces.",
    "rose": "No contact orientations: the pack was written without output.contacts = true, or has too few contacts.",
    "settling": "No history: the time series NAME.steps.csv of this run is not beside the pack."}


def plots(pack: Pack, analysis: dict[str, Any], folder: Path) -> str:
    """All plots that there are, and why the others are not."""
    drawn, notes = [], []
    for name, words in CAPTIONS.items():
        if name == "composition" and not pack.components or name == "radial" and "radial_profile" not in analysis:
            continue
        if name == "sizes" and pack.components:
            words = "Sizes of each component, as sieves would show them."
        path = folder / f"{name}.svg"
        if plot.draw(name, pack, analysis, path):
            adapt(path)
            drawn.append(f'<figure>{inline(path, "svg+xml", words)}<figcaption>{words}</figcaption></figure>')
        else:
            notes.append(f'<p class="note">{MISSING[name]}</p>')
    return f'<div class="pair">{"".join(drawn)}</div>{"".join(notes)}'


def adapt(path: Path) -> None:
    """Lets the plot follow the reader's choice of light or dark."""
    text = path.read_text()
    light, dark = [], []
    for k, (colour, other) in enumerate(DARK.items()):
        text = text.replace(colour, f"var(--c{k})")
        light.append(f"--c{k}:{colour}")
        dark.append(f"--c{k}:{other}")
    text = text.replace(f"fill: {BACKGROUND}", "fill: none")
    style = f"<style>svg{{{';'.join(light)}}}@media(prefers-color-scheme:dark){{svg{{{';'.join(dark)}}}}}</style>"
    start = text.index(">", text.index("<svg")) + 1
    path.write_text(text[:start] + style + text[start:])


def by_height(pack: Pack) -> bool:
    """Was a height asked for, and not a number of particles or a layer alone?"""
    return "target_particles" not in pack.summary and float(pack.scene()["layers"].get("duration", 1.0)) > 0.0


def against(words: str, target: Optional[float], there: float, shown: str) -> list[str]:
    """A row of what was asked for, if anything was, and what came."""
    if target is None:
        return [words, "–", shown, "–"]
    return [words, number(target), shown, percent(there, target)]


def comparison(pack: Pack, analysis: dict[str, Any]) -> str:
    """Targets beside what was achieved."""
    made = pack.summary
    inserted = [fraction for fraction in pack.layers["achieved_fraction"] if fraction > 0.0]   # none of layers taken over
    scale, unit = length_unit(made["target_height"])
    rows = [["The pack"],
            against("particles", made.get("target_particles"), pack.count, number(pack.count)),
            against(f"height [{unit}]", scale * made["target_height"] if by_height(pack) else None, scale * made["height"],
                    number(scale * made["height"], 5)),
            *([against("φ of a layer when inserted", made["target_fraction"], float(np.mean(inserted)), number(float(np.mean(inserted)), 5))]
              if inserted else []),
            ["φ below the lid" if "lid" in made else "φ below the target height", "–", f"{pack.phi:.4f}", "–"],
            against("φ of the bulk", made.get("target_phi_bulk"), pack.phi_bulk, f"{pack.phi_bulk:.4f}"),
            ["porosity of the bulk, 1 − φ", "–", f"{pack.porosity_bulk:.4f}", "–"],
            ["void ratio of the bulk, (1 − φ) / φ", "–", number(pack.void_ratio_bulk if pack.phi_bulk else None), "–"]]
    for one in analysis.get("composition", {}).get("components", []):
        index = "–" if one["lacey_index"] is None else f"{one['lacey_index']:.3f} ± {one['lacey_error']:.3f}"
        rows += [[f"Component {html.escape(one['name'])}"], ["particles", "–", number(one["count"]), "–"],
                 against("mass [kg]", one.get("target_mass"), one["mass"], number(one["mass"], 6)), ["mixing, Lacey's index (1: by chance)", "–", index, "–"]]
    for kind, match in analysis["sizes"].items():
        rows += size_rows(kind, match, 2.0 * pack.radius.max())
    return table(["", "target", "achieved", "difference"], rows, "target and achieved")


def size_rows(kind: str, match: dict[str, Any], largest: float) -> list[list[str]]:
    """Rows of the diameters by number or mass, in a unit that suits the largest [m]."""
    target, there = match["target"], match["achieved"]
    scale, unit = length_unit(largest)
    rows = [[f"Diameters by {kind}"]]
    rows += [[f"D<sub>{name[1:]}</sub> [{unit}]", number(scale * target[name]), number(scale * there[name]),
              percent(there[name], target[name])] for name in target if name.startswith("d")]
    rows += [[words, number(target[name]), number(there[name]), percent(there[name], target[name])]
             for name, words in (("cu", "C<sub>u</sub> = D<sub>60</sub> / D<sub>10</sub>"),
                                 ("cc", "C<sub>c</sub> = D<sub>30</sub>² / (D<sub>10</sub> D<sub>60</sub>)"))]
    return rows + [["Kolmogorov distance", "–", number(match["distance"], 3), "–"]]


def protocol(pack: Pack) -> str:
    """How the pack was made, as far as its numbers depend on it."""
    made, scene = pack.summary, pack.scene()
    dynamics, layers = scene["dynamics"], scene["layers"]
    window, settled = dynamics.get("window", 0), dynamics.get("stop") == "settled"
    return listed([
        ("time step", quantity(made["time_step"], "s", 6)),
        *([("layers", f"{len(pack.layers['inserted'])} of {length(layers['thickness'])}"),
           ("duration of a layer", quantity(layers["duration"], "s") + (" at most" if settled else "")),
           ("window", f"the {number(window)} newest layers move" if window else "none: all move")]
          if layers["duration"] > 0.0 else [("layers", "one, inserted and not moved")]),
        ("final relaxation",
         f"{number(made['relaxations'])}, {number(made['relaxation_steps'])} steps" if made["relaxations"] else "none"),
        ("simulated", f"{quantity(made['duration'], 's')} in {number(made['steps'])} steps"),
        ("gravity", quantity(scene["jamming"]["gravity"], "m/s²")),
        ("friction, damping", f"{number(scene['contact']['friction'])}, {number(scene['contact']['damping_ratio'])} of critical"),
        ("rotation", "yes" if dynamics.get("rotation", True) else "no"),
        ("ended by", html.escape(made["stop_reason"])),
        ("compaction rate left", f"{quantity(made['compaction_rate'], '1/s', 3)} of φ<sub>bulk</sub>")])


def layer_table(pack: Pack) -> str:
    """A row for each layer."""
    columns = pack.layers
    rows = [[str(k + 1), number(columns["inserted"][k]), number(columns["total"][k]), number(columns["height"][k]),
             number(columns["duration"][k]), number(columns["kinetic_per_mgd"][k], 3), number(columns["max_overlap"][k], 3),
             f"{columns['coordination'][k]:.2f}"] for k in range(len(columns["inserted"]))]
    heads = ["layer", "inserted", "in all", "height [m]", "time [s]", "kinetic energy / mgd", "largest overlap / r",
             "coordination"]
    return f"<details><summary>Layer by layer</summary>{table(heads, rows, 'layers')}</details>"


def verdict(bad: bool) -> str:
    """Whether a check is met."""
    return '<span class="bad">no</span>' if bad else '<span class="good">yes</span>'


REST = {"unbalanced_force": "forces balance: unbalanced force ratio", "kinetic_energy": "nothing moves: mean kinetic energy over m g d",
        "support": "floor and walls bear the weight: force over weight", "mean_overlap": "mean overlap over radius",
        "worst_overlap": "worst overlap over radius"}


def rest(pack: Pack) -> list[list[str]]:
    """Rows of the checks: how near to rest, beside the limits."""
    rows = []
    for name, words in REST.items():
        if name not in pack.rest:
            continue
        value, limit = pack.rest[name], pack.rest[f"{name}_limit"]
        target = 1.0 if name == "support" else 0.0
        asked = "" if limit >= 1e9 else f"; limit {number(limit, 3)}" if target == 0.0 else f"; 1 within {number(limit, 3)}"
        rows.append([words, f"{number(value, 3)}{asked}", verdict(limit < 1e9 and not abs(value - target) < limit)])
    return rows


def checks(pack: Pack) -> str:
    """What the run has verified of its pack."""
    audit = pack.audit
    rows = [["all inserted particles are there", f"{number(audit['found'])} of {number(audit['expected'])}", verdict(audit["lost"])],
            ["all numbers are finite", f"{number(audit['non_finite'])} are not", verdict(audit["non_finite"])],
            ["all centres are in the container", f"{number(audit['outside'])} are not", verdict(audit["outside"])],
            ["no overlap beyond half a radius", f"{number(audit['worst_overlap'], 3)} at most", verdict(audit["worst_overlap"] > 0.5)],
            ["no wall penetrated beyond half a radius", f"{number(audit['worst_wall_penetration'], 3)} at most",
             verdict(audit["worst_wall_penetration"] > 0.5)],
            *rest(pack),
            [f"the {'target height' if by_height(pack) else 'number of particles' if 'target_particles' in pack.summary else 'fraction of the layer'} "
             "was reached", f"stopped by {html.escape(pack.summary['stop_reason'])}", verdict(not pack.summary["reached"])]]
    return table(["check", "found", "met"], rows, "checks")


def ledger(pack: Pack) -> str:
    """Where the energy of the particles that moved last has gone."""
    steps = pack.steps()
    if not steps or "dissipated" not in steps:
        return '<p class="note">No energy ledger: the time series NAME.steps.csv of this run is not beside the pack.</p>'
    parts = ("kinetic energy", "rotational energy", "potential energy", "elastic energy", "dissipated")
    rows = [[name if name != "rotational energy" else "of which rotational", quantity(float(steps[name][-1]), "J")] for name in parts]
    return table(["energy of the moving particles at the end", ""], rows, "energy ledger")


def provenance(pack: Pack) -> str:
    """Version, seed, scene, machine."""
    made = pack.provenance
    scene = html.escape(made["effective_input"])
    return listed([
        ("packmpi", f"{html.escape(made['version'])} ({html.escape(made['git'])})"), ("seed", str(made["seed"])),
        ("scene", html.escape(made["scene_file"])), ("compiler", html.escape(made["compiler"])),
        ("instruction set", html.escape(made["architecture"])),
        ("ranks", f"{number(made['ranks'])}, {html.escape(made['decomposition'])}"),
        ("wall time", quantity(made["wall_seconds"], "s", 3)),
        ("speed", quantity(made["particle_steps_per_second"], "particle-steps/s", 3)),
    ]) + f"<details><summary>The scene with every default: a scene file itself</summary><pre>{scene}</pre></details>"


def page(pack: Pack, analysis: dict[str, Any], pixels: int) -> str:
    """The whole page; pictures are about `pixels` wide."""
    container = container_size(pack).replace("x", "×")
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        body = [
            f"<header><h1>{html.escape(pack.name)}</h1><p>{number(pack.count)} {pack.noun} in {container}, "
            f"seed {pack.provenance['seed']}, by packmpi {html.escape(pack.provenance['version'])}</p></header>",
            warning(pack), facts(pack, analysis), view(pack), pictures(pack, folder, pixels),
            section("plots", "What it is like", plots(pack, analysis, folder)),
            section("targets", "Target and achieved", comparison(pack, analysis),
                    '<p class="note">φ is the solid fraction: a product of the protocol below, not a constant of the material. The Kolmogorov distance is the largest one between the target and the achieved curve.</p>'),
            section("protocol", "Protocol", protocol(pack), layer_table(pack)),
            section("checks", "Checks", checks(pack), ledger(pack)),
            section("provenance", "Provenance", provenance(pack))]
    style = STYLE.read_text()
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src {script_source()}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<link rel="icon" href="data:,">
<title>{html.escape(pack.name)}: a pack of {pack.count} {pack.noun}</title>
<style>
{style}</style>
</head>
<body><main>
{chr(10).join(body)}
</main></body>
</html>
"""


def write_page(pack: Pack, path: Path, *, program: Union[str, None] = None, pixels: int = 700) -> int:
    """Writes the page on a pack that has a file; its length. Raises Problem."""
    text = page(pack, pack.analysis(program), pixels)
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise Problem(f"cannot write {path}: {error}") from error
    return len(text)


def main(words: list[str]) -> None:
    """packmpi report WORDS."""
    parser = argparse.ArgumentParser(prog="packmpi report", description="Write one page, HTML, on a pack (NAME.hdf).")
    parser.add_argument("pack", help="pack file, NAME.hdf")
    parser.add_argument("-o", "--output", type=named, help="page to write (default: NAME.html beside the pack)")
    parser.add_argument("--program", help="packmpi, to analyze the pack (default: this one)")
    parser.add_argument("--size", type=int, default=700, help="width of the pictures in pixels, about (default 700)")
    parser.add_argument("--crate", metavar="LICENCE", help="write ro-crate-metadata.json, too: a record of the pack and its files for an archive; an SPDX name (CC-BY-4.0) or an address")
    options = parser.parse_args(words)
    pack = Pack(options.pack)
    if pack.count == 0:
        raise Problem(f"{options.pack} has no particles")
    path: Path = options.output or Path(options.pack).with_suffix(".html")
    written = write_page(pack, path, program=options.program, pixels=options.size)
    print(f"{path}: {pack.count} particles, {written / 1024:.0f} kB")
    if options.crate:
        print(f"{write_record(pack, options.crate)}: a record for an archive (RO-Crate 1.1)")
