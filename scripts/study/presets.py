#!/usr/bin/python3
"""What the presets of `fidelity` with friction that has memory keep of the converged answer, and what they save: tables in doc/accuracy.md,
doc/images/presets.svg, every run a row in doc/data/presets.csv.

usage: scripts/study/presets.py [--scenes equal ...] [--settings balanced ...] [--seeds N] [--report-only]

Settings: "reference", the reference with half its step and with twice its durations (is it converged?), "balanced", "draft". Run as a user does: a scene
and `fidelity`. A row is made again when anything that the program would do differently, e.g. another rule of a preset, changes its scene as `packmpi check`
prints it: stop it at any time, start it again. All of it: about an hour of one core.
"""
import argparse
import csv
import json
import re
import shutil
import subprocess
from pathlib import Path

import measuring
import presets_report
from settling import digest, effective, packmpi_recipe, run

PERIODIC = {"container.boundary": '["periodic","periodic"]'}
MIXED = {"container.boundary": '["wall","periodic"]'}
EARTH = {"jamming.gravity": "9.81", "drag.coefficient": "0.0"}


def equal(radius):
    return {"particles.radius": f'{{distribution="equal",value="{radius}"}}'}


def box(width, depth, height, layer):
    size = ",".join(f'"{length}"' for length in (width, depth, height))
    return {"container.size": f"[{size}]", "layers.thickness": f'"{layer}"'}


MILLIMETRES = {**EARTH, **equal("1 mm"), "particles.density": "2500.0"}
# name: (changes to input/quickstart.toml, seeds, of them also with half the step and twice the duration, words)
SCENES = {
    "equal": ({**MILLIMETRES, **PERIODIC, **box("24 mm", "24 mm", "30 mm", "10 mm"), "contact.friction": "0.5"}, 6, 2,
              "equal spheres, periodic, mu 0.5"),
    "walls": (box("0.48 m", "0.48 m", "0.6 m", "0.1 m"), 6, 2, "of the paper's kind (g 2, drag), walls, mu 0.2"),
    "smooth": ({**EARTH, **PERIODIC, **equal("2 mm"), **box("48 mm", "48 mm", "60 mm", "20 mm"), "particles.density": "7800.0",
                "particles.youngs_modulus": "3e8", "contact.friction": "0.1", "contact.damping_ratio": "0.05"}, 4, 1, "heavy, equal, periodic, mu 0.1"),
    "rough": ({**EARTH, **MIXED, **box("0.32 m", "0.32 m", "0.4 m", "0.12 m"), "particles.density": "2650.0", "contact.friction": "1.0",
               "contact.damping_ratio": "0.2",
               "particles.radius": '{distribution="lognormal",median=0.015,log_sd=0.3,min=0.008,max=0.024,weighting="mass"}'}, 4, 0,
              "lognormal 1:3, mu 1"),
    "graded": ({**EARTH, **PERIODIC, **box("25 mm", "25 mm", "20 mm", "12 mm"), "particles.density": "2500.0", "particles.youngs_modulus": "2e7",
                "contact.friction": "0.4", "layers.attempts": "100000",
                "particles.radius": '{distribution="uniform",min="0.25 mm",max="4 mm",weighting="mass"}'}, 2, 0, "graded by mass 1:16, periodic, mu 0.4"),
    "bidisperse": ({**EARTH, **PERIODIC, **box("31 mm", "31 mm", "20 mm", "20 mm"), "particles.density": "2500.0", "particles.youngs_modulus": "5e7",
                    "contact.friction": "0.3", "layers.attempts": "100000",
                    "particles.radius": '{distribution="bidisperse",weighting="mass",small="0.5 mm",large="5 mm",large_share=0.85}'}, 3, 0,
                   "bidisperse 1:10, periodic, mu 0.3"),
    "discs": ({"container.dimension": "2", "container.size": "[2.0,1.0]", "container.boundary": '["wall"]', "layers.thickness": "0.2", "layers.fraction": "0.4",
               "particles.radius": '{distribution="uniform",min=0.014,max=0.026,weighting="number"}', "contact.friction": "0.3"}, 6, 2,
              "discs in the plane, uniform, walls, mu 0.3"),
    "no_spin": ({**MILLIMETRES, **PERIODIC, **box("24 mm", "24 mm", "30 mm", "10 mm"), "contact.friction": "0.3", "dynamics.rotation": "false"}, 4, 1,
                "equal, periodic, mu 0.3, rotation off"),
    "tall": ({**MILLIMETRES, **PERIODIC, **box("12 mm", "12 mm", "120 mm", "10 mm"), "contact.friction": "0.5"}, 2, 0, "60 d high, equal, periodic, mu 0.5"),
    "glass": ({**MILLIMETRES, **PERIODIC, **box("20 mm", "20 mm", "22 mm", "10 mm"), "particles.youngs_modulus": "63e9", "particles.poisson_ratio": "0.22",
               "contact.friction": "0.25", "contact.damping_ratio": "0.05"}, 2, 0, "glass beads of 2 mm, E 63 GPa, periodic, mu 0.25"),
    "powder": ({**EARTH, **PERIODIC, **box("560 um", "560 um", "600 um", "300 um"), "particles.density": "1010.0", "particles.youngs_modulus": "1.7e9",
                "particles.poisson_ratio": "0.4", "contact.friction": "0.4", "drag.coefficient": "1e-8",
                "particles.radius": '{distribution="lognormal",median="28 um",log_sd=0.2,min="20 um",max="40 um",weighting="mass"}'}, 2, 0,
               "polyamide powder of 40 to 80 micrometres, E 1.7 GPa, in air, mu 0.4; **held out**"),
    "gravel": ({**EARTH, **MIXED, **box("0.36 m", "0.36 m", "0.4 m", "0.15 m"), "particles.density": "2650.0", "particles.youngs_modulus": "5e8",
                "contact.friction": "0.6", "contact.damping_ratio": "0.3",
                "particles.radius": '{distribution="uniform",min=0.007,max=0.028,weighting="mass"}'}, 4, 0, "gravel 1:4, mu 0.6; **held out**"),
}
REFERENCE = {"fidelity": "reference"}
FINER, LONGER = "reference, step / 2", "reference, twice the durations"
SETTINGS = {"reference": REFERENCE, "balanced": {"fidelity": "balanced"}, "draft": {"fidelity": "draft"}, FINER: REFERENCE, LONGER: REFERENCE}
COLUMNS = ["scene", "setting", "seed", "recipe", "exit", "spheres", "layers", "phi_bulk", "coordination", "rattlers", "overlap", "worst_overlap",
           "unbalanced_force", "kinetic_energy", "support", "particle_steps", "cpu_seconds", "words"]


def planned(options):
    """(scene, setting, seed): what is held to what first, what shows that the reference is converged then."""
    first = [name for name in SETTINGS if name not in (FINER, LONGER)]
    for settings, place in ((first, 1), ([FINER, LONGER], 2)):
        chosen = {name: options.seeds or SCENES[name][place] for name in options.scenes}
        for seed in range(1, max(chosen.values()) + 1):
            yield from ((name, setting, seed) for name, most in chosen.items() if seed <= most for setting in settings if setting in options.settings)


def changes_of(options, base, name, setting):
    """The scene's, and what makes a finer or longer run of its reference."""
    changes = {**SCENES[name][0], **SETTINGS[setting]}
    if setting == FINER:
        said = subprocess.run([options.program, "check", base, *measuring.options_of(changes)], text=True, capture_output=True, env=measuring.ENVIRONMENT,
                              check=True).stdout
        changes["dynamics.time_step"] = f"{0.5 * float(re.search(r'time step ([0-9.e+-]+) s;', said)[1]):.5g}"
    if setting == LONGER:
        values = effective(options.program, base, changes)
        changes |= {key: f"{2.0 * values[table][name]:.6g}" for key, table, name in
                    (("layers.duration", "layers", "duration"), ("dynamics.relaxation", "dynamics", "relaxation"))}
    return changes


def outcome(options, base, changes, seed):
    """The measures of a run; only its exit code and words if it left no pack."""
    folder = options.results / "run"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    said, seconds, code = run([options.program, base, "-q", "--force", "--seed", seed, "-o", folder, *measuring.options_of(changes)], folder,
                              folder / "said", any_code=True)
    if code not in (0, 3):
        return {"exit": code, "words": said.strip().splitlines()[-1][:300]}
    report = json.loads((folder / f"{base.stem}.json").read_text())
    got, rest = report["achieved"], {name: measure["value"] for name, measure in report["rest"].items()}
    return {"exit": code, "spheres": got["particles"], "layers": len(report["layers"]), "overlap": got["mean_overlap"], "cpu_seconds": round(seconds, 2),
            **{key: got[key] for key in ("phi_bulk", "coordination", "rattlers", "particle_steps")},
            **{key: rest[key] for key in ("worst_overlap", "unbalanced_force", "kinetic_energy", "support")}}


def read_rows(path):
    if not path.exists():
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def write_rows(path, rows):
    order = list(SCENES)
    measuring.write_csv(path, COLUMNS, sorted(rows, key=lambda row: (order.index(row["scene"]), list(SETTINGS).index(row["setting"]), int(row["seed"]))))


def measure(options):
    base = measuring.bare_scene("quickstart", options.results)
    todo = list(planned(options))
    for k, (name, setting, seed) in enumerate(todo):
        changes = changes_of(options, base, name, setting)
        values = effective(options.program, base, changes)
        recipe = digest(packmpi_recipe(values, None), seed)
        rows = read_rows(options.data)
        same = {"scene": name, "setting": setting, "seed": str(seed)}
        others = [row for row in rows if any(row[key] != value for key, value in same.items())]
        if any(row["recipe"] == recipe for row in rows if row not in others):
            continue
        got = outcome(options, base, changes, seed)
        row = same | {"recipe": recipe} | {key: f"{value:.6g}" if isinstance(value, float) else value for key, value in got.items()}
        write_rows(options.data, [*others, row])
        print(f"{k + 1}/{len(todo)} " + ", ".join(f"{key} {row[key]}" for key in COLUMNS if key in row and key != "recipe"), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--settings", nargs="+", choices=SETTINGS, default=list(SETTINGS))
    parser.add_argument("--seeds", type=int, help="seeds 1 .. N in every scene")
    parser.add_argument("--report-only", action="store_true", help="report on the rows there are")
    parser.add_argument("--program", type=lambda text: Path(text).resolve(), default=measuring.ROOT / "build/packmpi")
    parser.add_argument("--results", type=lambda text: Path(text).resolve(), default=measuring.ROOT / "results/presets")
    parser.add_argument("--doc", type=Path, default=measuring.ROOT / "doc")
    options = parser.parse_args()
    options.data = options.doc / "data/presets.csv"
    if not options.report_only:
        measure(options)
    presets_report.write(options.doc, read_rows(options.data), {name: words for name, (*_, words) in SCENES.items()}, FINER, LONGER)


if __name__ == "__main__":
    main()
