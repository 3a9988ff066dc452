#!/usr/bin/python3
"""Does a pack depend on the time step or on the duration of its layers? The step halved and quartered, the duration doubled: tables in doc/rest.md,
doc/data/convergence.csv.

usage: scripts/study/convergence.py [--scenes small reference brick] [--seeds N] [--set KEY=VALUE ...]

small: 950 spheres, periodic, eight layers, ten seeds: 4 minutes of one core; reference: the same by the preset of that name: 6 minutes; brick: example 5.3, 9000
spheres, four seeds: 24 minutes. Runs are remembered in results/convergence. Packs of a scene hold equally many spheres.
"""
import argparse
import math
import statistics

from settling import Workshop, measuring

LAW = {"contact.tangential": "mindlin"}
SMALL = {"container.size": "[0.4,0.4,0.33]", "container.boundary": '["periodic","periodic"]', "layers.maximum": "8"}
# Settings, seeds, words; step and times [s] of a layer and of the final stage: of the examples, and of the preset ("auto": 1.64e-4).
SCENES = {"small": ({**SMALL, "fidelity": "paper"}, 10, "950 spheres, periodic, 8 layers", 1e-4, {"layers.duration": 1.0}),
          "reference": ({**SMALL, "fidelity": "reference"}, 10, "the same by `\"reference\"`", 1.6e-4,
                        {"layers.duration": 1.58, "dynamics.relaxation": 0.79}),
          "brick": ({"layers.maximum": "12", "fidelity": "paper"}, 4, "example 5.3, 12 layers", 1e-4, {"layers.duration": 1.0})}
VARIANTS = {"as it is": (1.0, 1.0), "step / 2": (0.5, 1.0), "step / 4": (0.25, 1.0), "twice the duration": (1.0, 2.0)}   # times step, durations
BOUNDS = {"phi_bulk": 0.001, "coordination": 0.03}
COLUMNS = ["scene", "variant", "seed", "spheres", "phi_bulk", "coordination", "coordination_bulk", "overlap", "kinetic", "cpu_seconds"]


def rows_of(options):
    workshop = Workshop(options.program, options.results)
    base = measuring.bare_scene("paper_5_3", options.results, ["regularisation"])
    more = dict(change.split("=", 1) for change in options.set)
    for scene in options.scenes:
        changes, seeds, _, step, times = SCENES[scene]
        for seed in range(1, (options.seeds or seeds) + 1):
            for variant, (of_step, of_times) in VARIANTS.items():
                values = {"dynamics.time_step": of_step * step, **{key: of_times * time for key, time in times.items()}}
                got = workshop.settled("packmpi", base, {**changes, **LAW, **{key: f"{value:g}" for key, value in values.items()}, **more}, seed)
                row = {"scene": scene, "variant": variant, "seed": seed, **{key: f"{got[key]:.6g}" for key in COLUMNS[3:]}}
                print(", ".join(str(row[key]) for key in COLUMNS), flush=True)
                yield row


def change(rows, variant, key):
    """Of a variant from the scene as it is, seed by seed: mean and standard error."""
    first = {row["seed"]: float(row[key]) for row in rows if row["variant"] == "as it is"}
    values = [float(row[key]) - first[row["seed"]] for row in rows if row["variant"] == variant]
    return statistics.mean(values), statistics.stdev(values) / math.sqrt(len(values)) if len(values) > 1 else math.nan


def table(rows):
    out = ["| scene | | phi_bulk | Z | mean overlap / r | KE / (m g d), worst | CPU s |", "|---|---|---|---|---|---|---|"]
    for scene, (_, _, words, *_) in SCENES.items():
        own = [row for row in rows if row["scene"] == scene]
        for variant in VARIANTS if own else ():
            some = [row for row in own if row["variant"] == variant]
            cells = []
            for key, digits in (("phi_bulk", 4), ("coordination", 3)):
                mean, error = change(own, variant, key)
                level = f"{statistics.mean(float(row[key]) for row in some):.{digits}f}"
                cells.append(level if variant == "as it is" else f"{mean:+.{digits}f} +- {error:.{digits}f}"
                             + (" **too much**" if abs(mean) > BOUNDS[key] + 2.0 * error else ""))
            cells += [f"{statistics.mean(float(row['overlap']) for row in some):.2e}", f"{max(float(row['kinetic']) for row in some):.0e}",
                      f"{statistics.mean(float(row['cpu_seconds']) for row in some):.0f}"]
            out.append("| " + " | ".join([f"{words}, {len(some)} seeds" if variant == "as it is" else "", variant, *cells]) + " |")
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--seeds", type=int, help="seeds 1 .. N in every scene")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="change the scenes")
    parser.add_argument("--program", type=measuring.Path, default=measuring.ROOT / "build/packmpi")
    parser.add_argument("--results", type=measuring.Path, default=measuring.ROOT / "results/convergence")
    parser.add_argument("--doc", type=measuring.Path, default=measuring.ROOT / "doc")
    options = parser.parse_args()
    rows = list(rows_of(options))
    measuring.write_csv(options.doc / "data/convergence.csv", COLUMNS, rows)
    print("\n".join(table(rows)))
    if (options.doc / "rest.md").exists():
        measuring.write_block(options.doc / "rest.md", "convergence", "\n".join([f"{measuring.made_by('scripts/study/convergence.py')}.", "", *table(rows)]))


if __name__ == "__main__":
    main()
