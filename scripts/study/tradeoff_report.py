"""The report of scripts/study/tradeoff.py: tables and plot for doc/accuracy.md from the rows of doc/data/tradeoff.csv."""
import math
import statistics

import measuring
from packmpi.style import ACHIEVED, LOOK, OTHER, TARGET

SHADES = ("#00798c", "#8d99ae", "#30638e", "#222222", "#e3a857", "#7a5195", "#4f8a5b")
KNOB_WORDS = {"step": "time step", "duration": "duration of a layer", "settled": "layers until settled", "layers": "layers' thickness, fraction", "stiffness": "softer while filling",
              "friction": "cap of friction", "window": "frozen bed", "relaxation": "final relaxation", "implicit": "implicit steps", "speed": "speed of insertion"}

BALANCED = {"phi_3d": 0.002, "phi_2d": 0.005, "coordination": 0.05, "overlap": 0.20, "fewer": 8.0}
DRAFT = {"phi": 0.010, "fewer": 20.0}


def number(row, key):
    return float(row[key]) if row.get(key) else math.nan


def made(rows, scene, setting):
    return [row for row in rows if row["scene"] == scene and row["setting"] == setting and row["particles"]]


class Noise:
    """Standard deviation of a measure from pack to pack in a scene, pooled over its settings: steadier than three seeds'."""

    def __init__(self, rows, scene):
        self.groups = {}
        for row in rows:
            if row["scene"] == scene and row["particles"]:
                self.groups.setdefault(row["setting"], []).append(row)

    def sd(self, key):
        squares = count = 0.0
        for group in self.groups.values():
            values = [number(row, key) for row in group]
            if len(values) > 1:
                squares += statistics.variance(values) * (len(values) - 1)
                count += len(values) - 1
        return math.sqrt(squares / count) if count else math.nan

    def of_difference(self, key, some, others):
        return self.sd(key) * math.sqrt(1.0 / len(some) + 1.0 / len(others))


def mean(rows, key):
    return statistics.mean(number(row, key) for row in rows)


def ratio(references, rows, key):
    """How many times less than the references."""
    return mean(references, key) / mean(rows, key)


def curve(rows, key):
    """Mean over the rows of each bin, and the variance of that mean."""
    columns = list(zip(*([float(word) for word in row[key].split()] for row in rows)))
    means = [statistics.mean(column) for column in columns]
    variances = [statistics.variance(column) / len(column) if len(column) > 1 else math.nan for column in columns]
    return means, variances


def distance(references, rows, key):
    """Root mean square of the difference of two mean curves, and what the scatter of the seeds alone gives."""
    (a, va), (b, vb) = curve(references, key), curve(rows, key)
    return (math.sqrt(statistics.mean((x - y) ** 2 for x, y in zip(a, b))),
            math.sqrt(statistics.mean(x + y for x, y in zip(va, vb))))


def is_2d(scene):
    return scene.startswith("2d")


def is_graded(scene):
    return "graded" in scene or scene.split("_")[0] in ("rock", "gravel", "cobbles", "regolith", "grit", "scree")   # their numbers differ from seed to seed


def misses(scene, setting, references, rows, noise):
    """Which bounds of the preset are missed, in words; empty: none."""
    phi = abs(mean(rows, "phi_bulk") - mean(references, "phi_bulk"))
    fewer = ratio(references, rows, "particle_steps")
    if setting == "draft":
        limit = max(DRAFT["phi"], 2.0 * noise.of_difference("phi_bulk", rows, references) if is_2d(scene) else 0.0)
        checks = {"phi_bulk": phi <= limit, "cost": fewer >= DRAFT["fewer"] or is_2d(scene)}
    else:
        limit = max(BALANCED["phi_2d"], 2.0 * noise.of_difference("phi_bulk", rows, references)) if is_2d(scene) else BALANCED["phi_3d"]
        touching = max(BALANCED["coordination"], 2.0 * noise.of_difference("coordination", rows, references) if is_2d(scene) else 0.0)
        checks = {"phi_bulk": phi <= limit,
                  "coordination": abs(mean(rows, "coordination") - mean(references, "coordination")) <= touching,
                  "overlap": abs(1.0 - 1.0 / ratio(references, rows, "mean_overlap")) <= BALANCED["overlap"],
                  "cost": fewer >= BALANCED["fewer"] or is_2d(scene)}
    checks["not the same mass"] = {row["particles"] for row in rows} == {row["particles"] for row in references} or is_graded(scene)
    return ", ".join(name for name, held in checks.items() if not held)


def difference(references, rows, noise, key, digits):
    return (f"{mean(rows, key) - mean(references, key):+.{digits}f} +- "
            f"{noise.of_difference(key, rows, references):.{digits}f}")


def times(factor):
    return "" if math.isnan(factor) else f"{factor:.1f}" if factor > 0.1 else f"{factor:.2g}"


def measures(references, rows, noise):
    """The cells every table has: differences from the reference, and what was saved."""
    return (f"{difference(references, rows, noise, 'phi_bulk', 4)} | {difference(references, rows, noise, 'coordination', 2)} | "
            f"{mean(rows, 'mean_overlap') / mean(references, 'mean_overlap'):.2f} | "
            f"{ratio(references, rows, 'particle_steps'):.1f} | {times(ratio(references, rows, 'contact_evaluations'))} | {times(ratio(references, rows, 'cpu_seconds'))}")


def reference_words(rows):
    spheres = sorted({row["particles"] for row in rows})
    return (f"{len(rows)} seeds, {' or '.join(spheres) if len(spheres) < 3 else spheres[0] + ' to ' + spheres[-1]} particles, "
            f"phi(H_d) {mean(rows, 'phi'):.4f}, phi_bulk {mean(rows, 'phi_bulk'):.4f}, coordination {mean(rows, 'coordination'):.2f}, "
            f"rattlers {100 * mean(rows, 'rattlers'):.1f} %, mean overlap {mean(rows, 'mean_overlap'):.1e} r, largest "
            f"{mean(rows, 'largest_overlap'):.1e} r, floor force / weight {mean(rows, 'floor_over_weight'):.3f}, "
            f"kinetic energy {mean(rows, 'kinetic_per_mgd'):.0e} m g d, {mean(rows, 'particle_steps'):.2e} particle-steps, "
            f"{mean(rows, 'cpu_seconds'):.1f} s")


def presets(rows, scenes, reference):
    out = ["| scene | preset | seeds | phi_bulk | coordination | overlap, ratio | fewer particle-steps | fewer contact evaluations | faster | beyond its bounds |",
           "|---|---|---|---|---|---|---|---|---|---|"]
    for scene, (*_, words) in scenes.items():
        references, noise = made(rows, scene, reference), Noise(rows, scene)
        for preset in ("balanced", "draft"):
            mine = made(rows, scene, preset)
            if references and mine:
                out.append(f"| {words} | {preset} | {len(mine)} | {measures(references, mine, noise)} | "
                           f"{misses(scene, preset, references, mine, noise) or 'nothing'} |")
    return out + [""]


def sinking(rows):
    """Of a mean layer's rise, the most; how many packs needed a second final stage."""
    twice = sum(number(row, "relaxations") > 1 for row in rows)
    return f"{max(number(row, 'sunk') for row in rows):.2f}" + (f"; {twice} twice" if twice else "")


def inside(rows, scenes, reference):
    """Rattlers, floor, motion left and the curves of `packmpi analyze`, for the presets."""
    out = ["| scene | preset | phi(H_d) | rattlers, % | largest overlap, ratio | floor force / weight | kinetic energy left, m g d | "
           "sinks in the final stage, layers | density profile | g(r) | forces |", "|---" * 11 + "|"]
    for scene in scenes:
        references, noise = made(rows, scene, reference), Noise(rows, scene)
        for preset in ("balanced", "draft"):
            mine = made(rows, scene, preset)
            if len(references) < 2 or len(mine) < 2:
                continue
            curves = " | ".join("{:.3f} ({:.3f})".format(*distance(references, mine, key)) for key in ("profile", "g", "forces"))
            out.append(f"| {scene} | {preset} | {difference(references, mine, noise, 'phi', 4)} | "
                       f"{100 * (mean(mine, 'rattlers') - mean(references, 'rattlers')):+.1f} | "
                       f"{mean(mine, 'largest_overlap') / mean(references, 'largest_overlap'):.2f} | {mean(mine, 'floor_over_weight'):.3f} | "
                       f"{mean(mine, 'kinetic_per_mgd'):.0e} | {sinking(mine)} | {curves} |")
    return out + [""]


def single_knobs(rows, knobs, reference):
    out = []
    for scene in dict.fromkeys(row["scene"] for row in rows):
        references, noise = made(rows, scene, reference), Noise(rows, scene)
        lines = []
        for knob, settings in knobs.items():
            for setting in settings if knob not in ("presets", "convergence") else ():
                mine = made(rows, scene, setting)
                if mine and references:
                    lines.append(f"| {knob} | {setting} | {len(mine)} | {measures(references, mine, noise)} |")
                failed = [row for row in rows if row["scene"] == scene and row["setting"] == setting and not row["particles"]]
                if failed:
                    lines.append(f"| {knob} | {setting} | {len(failed)} | exit code {failed[0]['exit']}: {failed[0]['words'].split('.toml: ')[-1].split('; it ended')[0]} | | | | | |")
        if lines:
            out += [f"Scene `{scene}`:", "", "| knob | setting | seeds | phi_bulk | coordination | overlap, ratio | fewer particle-steps | fewer contact evaluations | faster |",
                    "|---|---|---|---|---|---|---|---|---|", *lines, ""]
    return out


def convergence(rows, scenes):
    """phi_bulk and coordination against the step, for each way to regularise friction."""
    families = {"\"stop\": the slip may end within one step": {"0.25e-4": "dt 0.25e-4", "0.5e-4": "dt 0.5e-4", "1e-4": "paper", "2e-4": "dt 2e-4"},
                "\"viscous\", slip time 2e-4 s": {dt: f"slip time 2e-4, dt {dt}" for dt in ("0.25e-4", "0.5e-4", "1e-4")}}
    steps = ("0.25e-4", "0.5e-4", "1e-4", "2e-4")
    out = ["| scene | friction | " + " | ".join(f"dt {dt}" for dt in steps) + " |", "|---" * (len(steps) + 2) + "|"]
    for scene in scenes:
        noise = Noise(rows, scene)
        if not any(made(rows, scene, setting) for setting in families["\"viscous\", slip time 2e-4 s"].values()):
            continue
        for words, settings in families.items():
            cells = []
            for dt in steps:
                mine = made(rows, scene, settings.get(dt, ""))
                cells.append(f"{mean(mine, 'phi_bulk'):.4f} +- {noise.sd('phi_bulk') / math.sqrt(len(mine)):.4f} ({len(mine)}); "
                             f"{mean(mine, 'coordination'):.2f} +- {noise.sd('coordination') / math.sqrt(len(mine)):.2f}" if mine else "")
            out.append(f"| {scene} | {words} | " + " | ".join(cells) + " |")
    return [*out, ""]


def plot(path, rows, knobs, scenes, reference):
    """Cost against the change of the density: left the single knobs, right the presets on all scenes."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt
    plt.rcParams.update(LOOK)
    figure, (left, right) = plt.subplots(1, 2, figsize=(11.0, 4.6), sharey=True, layout="constrained")
    scene = "small_on"
    references, noise = made(rows, scene, reference), Noise(rows, scene)
    for k, (knob, settings) in enumerate(knobs.items()):
        points = [(ratio(references, mine, "particle_steps"), mean(mine, "phi_bulk") - mean(references, "phi_bulk"),
                   noise.of_difference("phi_bulk", mine, references))
                  for setting in settings if knob != "convergence" and (mine := made(rows, scene, setting)) and references]
        if points:
            x, y, e = zip(*points)
            left.errorbar(x, y, e, fmt="os^vD<>ph*XPd"[k % 13], color=TARGET if knob == "presets" else SHADES[k % len(SHADES)], linewidth=1,
                          label=KNOB_WORDS.get(knob, knob), markersize=8 if knob == "presets" else 5)
    left.set_title("one scene: single settings and presets")
    for preset, colour in (("balanced", ACHIEVED), ("draft", OTHER)):
        for plane, marker in ((False, "o"), (True, "s")):
            points = []
            for name in (name for name in scenes if is_2d(name) == plane):
                references, mine, noise = made(rows, name, reference), made(rows, name, preset), Noise(rows, name)
                if references and mine:
                    points.append((ratio(references, mine, "particle_steps"), mean(mine, "phi_bulk") - mean(references, "phi_bulk"),
                                   noise.of_difference("phi_bulk", mine, references)))
            if points:
                x, y, e = zip(*points)
                right.errorbar(x, y, e, fmt=marker, color=colour, linewidth=1, markersize=5, label=f"{preset}, {'discs' if plane else 'spheres'}")
    right.set_title("all scenes: presets")
    for axes in (left, right):
        axes.axhspan(-BALANCED["phi_3d"], BALANCED["phi_3d"], color=TARGET, alpha=0.14, linewidth=0, zorder=0)
        axes.set_xscale("log")
        axes.set_xticks([0.25, 0.5, 1, 2, 4, 8, 16, 32] if axes is left else [2, 4, 8, 16, 32], minor=False)
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter("")
        axes.set_xlabel("times fewer particle-steps than \"paper\"")
    left.legend(fontsize=7.5, loc="lower left", ncol=3)
    left.set_ylim(bottom=-0.0215)   # room for it
    right.legend(loc="upper right")
    left.set_ylabel(r'$\phi_\mathrm{bulk}$ less that of "paper"')
    figure.savefig(path, dpi=110)
    plt.close(figure)


def write(doc, rows, scenes, knobs, reference):
    total = sum(float(row["cpu_seconds"]) for row in rows)
    commits = sorted({row["commit"] for row in rows})
    text = [f"{measuring.made_by('scripts/study/tradeoff.py')}: {len(rows)} runs, {total / 60.0:.0f} minutes of CPU time, one rank each, "
            f"commits {', '.join(commits)}.", "", "#### The presets", "", *presets(rows, scenes, reference),
            "#### What the packs are like inside", "", *inside(rows, scenes, reference),
            "#### One knob at a time", "", *single_knobs(rows, knobs, reference),
            "#### Smaller steps", "", *convergence(rows, scenes),
            "#### The references", "",
            *(f"* `{scene}`: {words}; {reference_words(made(rows, scene, reference))}." for scene, (*_, words) in scenes.items()
              if made(rows, scene, reference))]
    print("\n".join(text))
    page = doc / "accuracy.md"
    if page.exists():
        measuring.write_block(page, "tradeoff", "\n".join(text))
    plot(doc / "images/tradeoff.png", rows, knobs, scenes, reference)
