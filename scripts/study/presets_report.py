"""The report of presets.py: tables in doc/accuracy.md and doc/images/presets.svg from the rows of doc/data/presets.csv."""
import math
import statistics

import measuring
from packmpi.style import ACHIEVED, LOOK, OTHER, TARGET

# How far from the converged answer, overlap as a share of it; and how many times fewer particle-steps in 3D.
BOUNDS = {"balanced": {"phi_bulk": 0.002, "coordination": 0.05, "overlap": 0.20}, "draft": {"phi_bulk": 0.010}}
FEWER = {"balanced": 8.0, "draft": 20.0}
SAME = {"phi_bulk": 0.001, "coordination": 0.03}   # what half the step and twice the durations may change in the reference
NAMES = {"phi_bulk": "phi_bulk", "coordination": "Z", "overlap": "overlap"}


def made(rows, scene, setting):
    return [row for row in rows if row["scene"] == scene and row["setting"] == setting and row["phi_bulk"]]


def mean(rows, key):
    return statistics.mean(float(row[key]) for row in rows)


def scatter(rows, scene, key):
    """Standard deviation from seed to seed, pooled over the settings of a scene, and from how many degrees of freedom."""
    squares, free = 0.0, 0
    for setting in {row["setting"] for row in rows if row["scene"] == scene}:
        values = [float(row[key]) for row in made(rows, scene, setting)]
        if len(values) > 1:
            squares, free = squares + statistics.variance(values) * (len(values) - 1), free + len(values) - 1
    return math.sqrt(squares / free) if free else math.nan


def difference(rows, scene, setting, key):
    """From the reference: means and standard error; of the overlap relative to it."""
    own, reference = made(rows, scene, setting), made(rows, scene, "reference")
    scale = mean(reference, key) if key == "overlap" else 1.0
    error = scatter(rows, scene, key) * math.sqrt(1.0 / len(own) + 1.0 / len(reference))
    return (mean(own, key) - mean(reference, key)) / scale, error / scale


def verdict(value, error, bound):
    """Held; missed by more than two standard errors; or open: beyond the bound by less."""
    if abs(value) <= bound:
        return ""
    return " (open)" if not abs(value) > bound + 2.0 * error else " **missed**"


def cell(rows, scene, setting, key, bound):
    value, error = difference(rows, scene, setting, key)
    if key == "overlap":
        return f"{100.0 * value:+.0f} +- {100.0 * error:.0f} %" + verdict(value, error, bound)
    digits = {"phi_bulk": 4, "coordination": 2}[key]
    return f"{value:+.{digits}f} +- {error:.{digits}f}" + verdict(value, error, bound)


def fewer(rows, scene, setting):
    return mean(made(rows, scene, "reference"), "particle_steps") / mean(made(rows, scene, setting), "particle_steps")


def codes(rows, scene, setting):
    return ", ".join(sorted({row["exit"] for row in rows if row["scene"] == scene and row["setting"] == setting}))


def preset_table(rows, scenes, setting):
    out = ["| scene | seeds | phi_bulk | Z | mean overlap | fewer particle-steps | faster | at rest (exit code) |", "|---|---|---|---|---|---|---|---|"]
    for scene, words in scenes.items():
        own = made(rows, scene, setting)
        if not own or not made(rows, scene, "reference"):
            continue
        bounds, saved = BOUNDS[setting], fewer(rows, scene, setting)
        cells = [cell(rows, scene, setting, key, bounds.get(key, math.inf)) for key in NAMES]
        short = " **missed**" if saved < FEWER[setting] and scene != "discs" else ""
        faster = mean(made(rows, scene, "reference"), "cpu_seconds") / mean(own, "cpu_seconds")
        out.append("| " + " | ".join([words, str(len(own)), *cells, f"{saved:.1f}{short}", f"{faster:.1f}", codes(rows, scene, setting)]) + " |")
    return out


def reference_table(rows, scenes, finer, longer):
    out = ["| scene | seeds | spheres, layers | phi_bulk | Z | mean overlap / r | step / 2: phi_bulk | Z | twice the durations: phi_bulk | Z |",
           "|---|---|---|---|---|---|---|---|---|---|"]
    for scene in scenes:
        own = made(rows, scene, "reference")
        if not own:
            continue
        cells = [f"{mean(own, 'spheres'):.0f}, {mean(own, 'layers'):.0f}", f"{mean(own, 'phi_bulk'):.4f}", f"{mean(own, 'coordination'):.3f}",
                 f"{mean(own, 'overlap'):.1e}"]
        for setting in (finer, longer):
            some = made(rows, scene, setting)
            cells += [cell(rows, scene, setting, key, SAME[key]) + (f" ({len(some)})" if key == "phi_bulk" else "") if some else "" for key in SAME]
        out.append("| " + " | ".join([scene, str(len(own)), *cells]) + " |")
    together = ["all scenes", "", "", "", "", ""]
    for setting in (finer, longer):
        common = [scene for scene in scenes if made(rows, scene, setting) and made(rows, scene, "reference")]
        together += [pooled(rows, common, setting, key) if common else "" for key in SAME]
    return [*out, "| " + " | ".join(together) + " |"]


def pooled(rows, scenes, setting, key):
    """Mean change over the scenes, each weighted by its precision."""
    values = [difference(rows, scene, setting, key) for scene in scenes]
    weights = [1.0 / error ** 2 for _, error in values if error > 0.0]
    values = [value for value, error in values if error > 0.0]
    if not weights:
        return ""
    value, error = sum(w * v for w, v in zip(weights, values)) / sum(weights), 1.0 / math.sqrt(sum(weights))
    digits = {"phi_bulk": 4, "coordination": 2}[key]
    return f"{value:+.{digits}f} +- {error:.{digits}f}" + verdict(value, error, SAME[key])


def inside_table(rows, scenes):
    out = ["| scene | preset | rattlers, % | worst overlap / r | unbalanced force ratio | KE / (m g d) | support | words of runs that left no pack |",
           "|---|---|---|---|---|---|---|---|"]
    for scene in scenes:
        for setting in ("reference", "balanced", "draft"):
            own = made(rows, scene, setting)
            if own:
                worst = {key: max(float(row[key]) for row in own) for key in ("worst_overlap", "unbalanced_force", "kinetic_energy")}
                words = "; ".join(sorted({row["words"] for row in rows if row["scene"] == scene and row["setting"] == setting and row["words"]}))
                out.append(f"| {scene} | {setting} | {100.0 * mean(own, 'rattlers'):.1f} | {worst['worst_overlap']:.1e} | {worst['unbalanced_force']:.0e} | "
                           f"{worst['kinetic_energy']:.0e} | {mean(own, 'support'):.3f} | {words} |")
    return out


def plot(path, rows, scenes):
    """A row of the plot for each scene: what the presets change in density and contacts, and what they save."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt
    plt.rcParams.update(LOOK)
    names = [scene for scene in scenes if made(rows, scene, "reference")]
    figure, panels = plt.subplots(1, 4, figsize=(9.6, 0.5 + 0.32 * len(names)), layout="constrained", sharey=True)
    shown = {"phi_bulk": 0.012, "coordination": 0.4, "overlap": 0.3}   # what is beyond stands in the table
    titles = {"phi_bulk": r"$\Delta\phi_\mathrm{bulk}$", "coordination": r"$\Delta$ coordination number", "overlap": r"$\Delta$ mean overlap, relative", "fewer": "times fewer particle-steps"}
    for axes, key in zip(panels, titles):
        for setting, colour, marker in (("balanced", ACHIEVED, "o"), ("draft", OTHER, "s")):
            lines = [k for k, scene in enumerate(names) if made(rows, scene, setting)]
            points = [(fewer(rows, names[k], setting), 0.0) if key == "fewer" else difference(rows, names[k], setting, key) for k in lines]
            if points:
                values, errors = zip(*points)
                axes.errorbar(values, lines, xerr=errors, fmt=marker, color=colour, markersize=4, linewidth=1, label=setting)
        if key in shown:
            axes.set_xlim(-shown[key], shown[key])
            axes.locator_params(axis="x", nbins=4)
        bound = BOUNDS["balanced"].get(key)
        if bound:
            axes.axvspan(-bound, bound, color=TARGET, alpha=0.14, linewidth=0)
        axes.set_title(titles[key], fontsize=9)
    panels[3].set_xscale("log")
    panels[3].set_xticks([2, 5, 10, 20, 50], ["2", "5", "10", "20", "50"])
    panels[3].set_xticks([], minor=True)
    for bound in FEWER.values():
        panels[3].axvline(bound, color=TARGET, alpha=0.4, linewidth=1)
    panels[0].set_yticks(range(len(names)), [name + (" (held out)" if "held out" in scenes[name] else "") for name in names])
    panels[0].invert_yaxis()
    panels[3].legend(fontsize=8, loc="lower right")
    figure.savefig(path, metadata={"Date": None})


def write(doc, rows, scenes, finer, longer):
    """Blocks of doc/accuracy.md and doc/images/presets.svg."""
    total = sum(float(row["cpu_seconds"]) for row in rows if row["cpu_seconds"])
    text = [f"{measuring.made_by('scripts/study/presets.py')}: {len(rows)} runs, {total / 60.0:.0f} minutes of CPU time, one rank each.", "",
            "### `\"balanced\"` less `\"reference\"`", "", *preset_table(rows, scenes, "balanced"), "",
            "### `\"draft\"` less `\"reference\"`", "", *preset_table(rows, scenes, "draft"), "",
            "### Is the reference converged?", "", *reference_table(rows, scenes, finer, longer), "",
            "### What the packs are like inside", "", "The worst of the seeds; mean rattlers and support.", "", *inside_table(rows, scenes)]
    print("\n".join(text))
    measuring.write_block(doc / "accuracy.md", "presets", "\n".join(text))
    plot(doc / "images/presets.svg", rows, scenes)
