#!/usr/bin/python3
"""What each way to a shorter run saves and what it changes in the pack, at equal inserted mass: a table in
doc/performance.md, its data in doc/data/speedups.csv.

usage: scripts/study/speedups.py [--seeds 4] [--scenes 3d_on 3d_off 2d_on 2d_off] [--settings A2 balanced ...] [--report-only]

Runs build/packmpi on examples 5.3 and 5.1 (twelve layers, so every pack of a scene holds the same spheres), one rank, one run
at a time. Runs are kept in results/speedups and not repeated while the program's sources and the settings are the same:
stop it at any time and start it again. CPU seconds are worth something on a machine that does nothing else.
"""
import argparse
import csv
import json
import os
import resource
import statistics
import subprocess
import sys
from pathlib import Path

import measuring

SCENES = {"3d_on": ("paper_5_3", {"layers.maximum": "12"}, "example 5.3, rotation on"),
          "3d_off": ("paper_5_3", {"layers.maximum": "12", "dynamics.rotation": "false"}, "example 5.3, rotation off"),
          "2d_on": ("paper_5_1", {"layers.maximum": "12"}, "example 5.1 (2D), rotation on"),
          "2d_off": ("paper_5_1", {"layers.maximum": "12", "dynamics.rotation": "false"}, "example 5.1 (2D), rotation off")}
DOWN = {3: "[0.0,0.0,-0.3]", 2: "[0.0,-0.3]"}


def settings(dimension):
    """Settings by name. In 2D r is half as large, and the limit of eq. (23) with it: its steps are shorter."""
    down = {"layers.velocity": DOWN[dimension]}
    soft = {"layers.youngs_modulus": "1e7", "layers.time_step": "5.9e-4" if dimension == 3 else "2.9e-4"}
    larger = {"dynamics.time_step": "2e-4" if dimension == 3 else "1.2e-4"}
    return {
        "reference": {},
        "insertion speed 0.3 m/s": down,
        "settled": {"dynamics.stop": "settled"},
        "window 5, relaxation 0.9 s": {"dynamics.window": "5", "dynamics.relaxation": "0.9"},
        "soft layers, relaxation 0.9 s": {**soft, "dynamics.relaxation": "0.9"},
        "larger step": larger,
        "A2": {**larger, **down, "layers.duration": "0.35" if dimension == 3 else "0.5", "dynamics.relaxation": "0.6" if dimension == 3 else "1.0"},
        "balanced": {"fidelity": "balanced", **measuring.SLIDING},
    }


def source():
    """What the program's packs depend on: the tree of src/, or the commit with its local changes."""
    dirty = subprocess.run(["git", "status", "--porcelain", "src"], cwd=measuring.ROOT, capture_output=True, text=True, check=False).stdout
    tree = subprocess.run(["git", "rev-parse", "HEAD:src"], cwd=measuring.ROOT, capture_output=True, text=True, check=False).stdout.strip()
    return tree + ("-dirty" if dirty else "")


def make(options, scene, name, seed):
    """One row of the data."""
    file, common, _ = SCENES[scene]
    values = {"fidelity": "paper", **common, **settings(int(scene[0]))[name]}
    folder = options.results / scene / "".join(c if c.isalnum() else "_" for c in name) / f"seed_{seed}"
    kept = folder / "row.json"
    key = [options.source, values]
    if kept.exists() and json.loads(kept.read_text())["key"] == key:
        return json.loads(kept.read_text())["row"]
    if options.report_only:
        return None
    folder.mkdir(parents=True, exist_ok=True)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([options.program, measuring.bare_scene(file, options.results), "-q", "--force", "--seed", str(seed), "-o", folder,
                           *measuring.options_of(values)], env=measuring.ENVIRONMENT,
                          stdout=subprocess.DEVNULL, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in (0, 3):
        sys.exit(f"speedups: {scene}, {name}, seed {seed} ended with exit code {done.returncode}")
    got = json.loads((folder / f"{file}.json").read_text())["achieved"]
    row = {"scene": scene, "setting": name, "seed": seed, "spheres": got["particles"], "particle_steps": got["particle_steps"],
           "cpu_seconds": round(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, 3),
           "phi_bulk": got["phi_bulk"], "coordination": got["coordination"], "mean_overlap": got["mean_overlap"]}
    kept.write_text(json.dumps({"key": key, "row": row}))
    (folder / f"{file}.hdf").unlink(missing_ok=True)   # the figures suffice
    print(f"{scene}, {name}, seed {seed}: {row['cpu_seconds']:.1f} s, phi_bulk {row['phi_bulk']:.4f}", flush=True)
    return row


def difference(rows, references, key):
    """Mean over the seeds both have of row - reference, and its standard error."""
    pairs = [row[key] - references[row["seed"]][key] for row in rows if row["seed"] in references]
    error = statistics.stdev(pairs) / len(pairs) ** 0.5 if len(pairs) > 1 else float("nan")
    return statistics.mean(pairs), error


def table(scene, rows):
    references = {row["seed"]: row for row in rows if row["setting"] == "reference"}
    if not references:
        return []
    mean = {key: statistics.mean(row[key] for row in references.values()) for key in ("phi_bulk", "coordination", "mean_overlap")}
    out = [f"**{SCENES[scene][2]}**: {len(references)} seeds; reference phi_bulk {mean['phi_bulk']:.4f}, coordination {mean['coordination']:.3f}, "
           f"mean overlap {mean['mean_overlap']:.2e} r.", "",
           "| setting | particle-steps | fewer | CPU s | faster | phi_bulk | coordination | mean overlap / reference | within |",
           "|---|---|---|---|---|---|---|---|---|"]
    for name in settings(int(scene[0])):
        mine = [row for row in rows if row["setting"] == name]
        if not mine:
            continue
        if any(row["spheres"] != references[row["seed"]]["spheres"] for row in mine if row["seed"] in references):
            sys.exit(f"speedups: {scene}, {name}: not the reference's spheres, so not comparable")
        steps, cpu = (statistics.median(row[key] for row in mine) for key in ("particle_steps", "cpu_seconds"))
        steps0, cpu0 = (statistics.median(row[key] for row in references.values()) for key in ("particle_steps", "cpu_seconds"))
        phi, phi_error = difference(mine, references, "phi_bulk")
        contacts, contacts_error = difference(mine, references, "coordination")
        overlap = statistics.mean(row["mean_overlap"] for row in mine) / mean["mean_overlap"]
        within = (abs(phi) <= measuring.BOUNDS["phi_bulk"] and abs(contacts) <= measuring.BOUNDS["coordination"]
                  and abs(overlap - 1.0) <= measuring.BOUNDS["overlap"])
        out.append(f"| {name} | {steps:.2e} | {steps0 / steps:.1f} | {cpu:.1f} | {cpu0 / cpu:.1f} | {phi:+.4f} +- {phi_error:.4f} | "
                   f"{contacts:+.3f} +- {contacts_error:.3f} | {overlap:.2f} | {'yes' if within else 'no'} |")
    return out + [""]


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=4, help="seeds 1 .. N")
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--settings", nargs="+", choices=settings(3), default=list(settings(3)))
    parser.add_argument("--report-only", action="store_true", help="report on the runs there are")
    parser.add_argument("--program", type=Path, default=measuring.ROOT / "build/packmpi")
    parser.add_argument("--results", type=Path, default=measuring.ROOT / "results/speedups")
    parser.add_argument("--doc", type=Path, default=measuring.ROOT / "doc")
    options = parser.parse_args()
    options.program, options.results, options.source = options.program.resolve(), options.results.resolve(), source()
    return options


def main():
    options = parse()
    rows = [make(options, scene, name, seed) for seed in range(1, options.seeds + 1) for scene in options.scenes
            for name in options.settings]
    rows = sorted((row for row in rows if row), key=lambda row: (row["scene"], row["setting"], row["seed"]))
    if not rows:
        sys.exit("speedups: no runs there")
    with open(options.doc / "data/speedups.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]), lineterminator=os.linesep)
        writer.writeheader()
        writer.writerows(rows)
    bounds = measuring.BOUNDS
    text = [f"{measuring.made_by('scripts/study/speedups.py')}. One rank; medians of CPU seconds from start to written pack; differences from the "
            f"reference seed by seed, mean +- standard error. Within: {bounds['phi_bulk']} in phi_bulk, {bounds['coordination']} in "
            f"coordination, {bounds['overlap'] * 100:.0f} % in mean overlap.", ""]
    for scene in options.scenes:
        text += table(scene, [row for row in rows if row["scene"] == scene])
    text += ["Settings: " + "; ".join(f"3D {name}: `{' '.join(measuring.options_of(values))}`" for name, values in settings(3).items()
                                      if values and name in options.settings) + "."]
    print("\n".join(text))
    measuring.write_block(options.doc / "performance.md", "speedups", "\n".join(text))


if __name__ == "__main__":
    main()
