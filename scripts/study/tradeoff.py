#!/usr/bin/python3
"""What each way to a cheaper pack changes in it, one knob at a time, and whether the presets of `fidelity` keep their
bounds: a table in doc/accuracy.md, a plot in doc/images, every run a row in doc/data/tradeoff.csv.

usage: scripts/study/tradeoff.py [--scenes brick_on ...] [--knobs presets step ...] [--seeds N] [--report-only] [--fresh]

A row is not made again while its scene, setting, seed and options are there: stop it at any time, start it again.
One run at a time, one rank. Seeds are by scene, as few as show what is to be shown on two cores; more: --seeds. All of it
is about two and a half hours of one core. Packs of a scene hold the same spheres, unless a knob changes the layers.
"""
import argparse
import csv
import fcntl
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import time
from pathlib import Path

import measuring
import tradeoff_report
from tradeoff_report import is_2d

OFF = {"dynamics.rotation": "false"}
BRICK = {"container.size": "[0.6,0.6,0.5]", "layers.maximum": "12"}
TALL = {"container.size": "[0.6,0.6,1.0]", "layers.maximum": "24"}
SMALL = {"container.size": "[0.4,0.4,0.33]", "container.boundary": '["periodic","periodic"]', "layers.maximum": "8"}
TINY = {"container.size": "[0.2,0.2,0.25]", "container.boundary": '["periodic","periodic"]', "layers.maximum": "6"}
ELEVEN = {"layers.maximum": "11"}
PERIODIC = {"container.boundary": '["periodic","periodic"]'}
# Coarse rock, nothing of it as in the paper's examples: size, shape of the grading, density, modulus, friction, damping, gravity.
ROCK = {"container.size": "[3.0,3.0,2.5]", "container.boundary": '["wall","periodic"]', "layers.maximum": "12", "layers.thickness": "0.5",
        "particles.density": "2650.0", "particles.youngs_modulus": "1e9", "contact.friction": "0.5", "contact.damping_ratio": "0.3",
        "drag.coefficient": "0.0", "jamming.gravity": "9.81",
        "particles.radius": '{distribution="lognormal",median=0.1,log_sd=0.2,min=0.065,max=0.15,weighting="mass"}'}
# Another one: a uniform grading by mass, lighter, softer, less rough, less damped, a higher bed.
GRAVEL = {"container.size": "[2.5,2.0,2.0]", "container.boundary": '["periodic","wall"]', "layers.maximum": "10", "layers.thickness": "0.5",
          "particles.density": "1800.0", "particles.youngs_modulus": "3e8", "particles.poisson_ratio": "0.2", "contact.friction": "0.35",
          "contact.damping_ratio": "0.2", "drag.coefficient": "0.0", "jamming.gravity": "9.81",
          "particles.radius": '{distribution="uniform",min=0.04,max=0.09,weighting="mass"}'}
# And a third.
COBBLES = {"container.size": "[2.2,2.2,2.4]", "layers.maximum": "14", "layers.thickness": "0.4", "particles.density": "2000.0",
           "particles.youngs_modulus": "4e8", "contact.friction": "0.3", "contact.damping_ratio": "0.15", "drag.coefficient": "0.0",
           "jamming.gravity": "8.0",
           "particles.radius": '{distribution="bidisperse",small=0.06,large=0.09,large_share=0.5,weighting="mass"}'}

# Heavy, smooth, equal, small beside a layer.
SHOT = {"container.size": "[1.4,1.4,2.0]", "container.boundary": '["periodic","wall"]', "layers.maximum": "12", "layers.thickness": "0.4",
        "particles.density": "7800.0", "particles.youngs_modulus": "1e9", "particles.poisson_ratio": "0.3", "contact.friction": "0.15",
        "contact.damping_ratio": "0.05", "drag.coefficient": "0.0", "jamming.gravity": "8.0",
        "particles.radius": '{distribution="equal",value=0.05}'}
# Rough and graded, large beside a layer.
REGOLITH = {"container.size": "[2.6,2.6,2.1]", "layers.maximum": "14", "layers.thickness": "0.35", "particles.density": "1500.0",
            "particles.youngs_modulus": "3e8", "contact.friction": "0.4", "contact.damping_ratio": "0.2", "drag.coefficient": "0.0",
            "jamming.gravity": "7.0",
            "particles.radius": '{distribution="weibull",scale=0.085,shape=5.0,min=0.05,max=0.12,weighting="number"}'}
# Nothing was chosen by the next two: small beside a layer; and small and very rough.
GRIT = {"container.size": "[1.0,1.1,1.5]", "container.boundary": '["wall","periodic"]', "layers.maximum": "12", "layers.thickness": "0.3",
        "particles.density": "2650.0", "particles.youngs_modulus": "5e8", "contact.friction": "0.25", "contact.damping_ratio": "0.3",
        "drag.coefficient": "0.0", "jamming.gravity": "6.0",
        "particles.radius": '{distribution="uniform",min=0.03,max=0.05,weighting="number"}'}
SCREE = {"container.size": "[1.0,0.9,1.6]", "container.boundary": '["periodic","periodic"]', "layers.maximum": "12", "layers.thickness": "0.32",
         "particles.density": "2700.0", "particles.youngs_modulus": "6e8", "contact.friction": "0.45", "contact.damping_ratio": "0.25",
         "drag.coefficient": "0.0", "jamming.gravity": "6.4",
         "particles.radius": '{distribution="lognormal",median=0.04,log_sd=0.25,min=0.025,max=0.06,weighting="mass"}'}
ELEVEN_OFF = {**ELEVEN, **OFF}   # looser packs need fewer layers; as many under each preset

# name: file, changes, seeds, words. The paper's own step and duration stand in the files and are left out, so that
# `fidelity` alone says how a pack is made.
SCENES = {
    "small_on": ("paper_5_3", SMALL, 10, "3D, equal, periodic, 8 layers, rotation on"),
    "brick_on": ("paper_5_3", BRICK, 8, "3D, equal, 12 layers, rotation on"),
    "brick_off": ("paper_5_3", {**BRICK, **OFF}, 8, "the same, rotation off"),
    "tall_on": ("paper_5_3", TALL, 4, "3D, equal, 24 layers, rotation on"),
    "tall_off": ("paper_5_3", {**TALL, **OFF, "layers.maximum": "23"}, 4, "the same, rotation off"),
    "graded_on": ("paper_5_4", {**BRICK, **PERIODIC}, 8, "3D, Gaussian, periodic, 12 layers, rotation on"),
    "graded_off": ("paper_5_4", {**BRICK, **PERIODIC, **OFF}, 8, "the same, rotation off"),
    "2d_on": ("paper_5_1", ELEVEN, 10, "2D, equal (example 5.1), 11 layers, rotation on"),
    "2d_off": ("paper_5_1", ELEVEN_OFF, 10, "the same, rotation off"),
    "2d_graded_on": ("paper_5_2", ELEVEN, 10, "2D, Gaussian (example 5.2), 11 layers, rotation on"),
    "2d_graded_off": ("paper_5_2", ELEVEN_OFF, 10, "the same, rotation off"),
    "rough_off": ("paper_5_3", {**BRICK, **OFF, "contact.friction": "0.4", "container.size": "[0.6,0.6,0.54]"}, 8,
                  "3D, equal, 12 layers, friction 0.4, rotation off"),
    "rock": ("paper_5_3", ROCK, 8, "3D, lognormal rock of 65 to 150 mm, friction 0.5, g 9.81"),
    "rock_off": ("paper_5_3", {**ROCK, **ELEVEN_OFF}, 8, "the same, rotation off"),
    "gravel": ("paper_5_3", GRAVEL, 8, "3D, uniform gravel of 40 to 90 mm, friction 0.35, g 9.81"),
    "gravel_off": ("paper_5_3", {**GRAVEL, **OFF}, 8, "the same, rotation off"),
    "cobbles": ("paper_5_3", COBBLES, 8, "3D, bidisperse cobbles of 120 and 180 mm, friction 0.3, g 8"),
    "shot": ("paper_5_3", SHOT, 8, "3D, equal heavy shot of 100 mm, friction 0.15, g 8"),
    "regolith": ("paper_5_3", REGOLITH, 8, "3D, Weibull regolith of 100 to 240 mm, friction 0.4, g 7"),
    "regolith_off": ("paper_5_3", {**REGOLITH, **OFF, "layers.maximum": "13"}, 8, "the same, rotation off"),
    "grit": ("paper_5_3", GRIT, 8, "3D, uniform grit of 60 to 100 mm, friction 0.25, g 6; **kept apart**"),
    "grit_off": ("paper_5_3", {**GRIT, **ELEVEN_OFF}, 8, "the same, rotation off"),
    "scree": ("paper_5_3", SCREE, 8, "3D, lognormal scree of 50 to 120 mm, friction 0.45, g 6.4; **kept apart**"),
    "scree_off": ("paper_5_3", {**SCREE, **ELEVEN_OFF}, 8, "the same, rotation off; **kept apart**"),
    "tiny_on": ("paper_5_3", TINY, 4, "3D, equal, periodic, 6 layers, rotation on; for the implicit steps"),
}
WITHOUT_PRESETS = {"tiny_on"}
PAPER = {"fidelity": "paper"}
REFERENCE = "paper"


def viscous(slip_time):
    return {"contact.regularisation": "viscous", "contact.slip_time": slip_time}


# Of the examples' layers: thickness and phi_0 in 3D and in the plane.
LAYERS_3D, LAYERS_2D = {"thickness": 0.1, "fraction": 0.25}, {"thickness": 0.1, "fraction": 0.4}


def down(speed):
    """Options of a scene that insert at this speed."""
    return lambda scene: {"layers.velocity": f"[0.0,-{speed}]" if is_2d(scene) else f"[0.0,0.0,-{speed}]"}


def layers(key, factor):
    """Options of a scene that make its layers so many times as thick or as full, and as many fewer of them."""
    def options(scene):
        usual = (LAYERS_2D if is_2d(scene) else LAYERS_3D)[key]
        most = int(SCENES[scene][1]["layers.maximum"])
        return {f"layers.{key}": f"{usual * factor:.4g}", "layers.maximum": str(int(most / factor))}
    return options


# knob: {setting: options, or a function of the scene that gives them}
KNOBS = {
    "presets": {name: {"fidelity": name, **measuring.SLIDING} for name in ("balanced", "draft")},
    "step": {f"dt {dt}": {"dynamics.time_step": dt} for dt in ("0.25e-4", "0.5e-4", "2e-4", "2.4e-4", "3e-4")},
    "convergence": {f"slip time 2e-4, dt {dt}": {**viscous("2e-4"), "dynamics.time_step": dt}
                    for dt in ("0.25e-4", "0.5e-4", "1e-4")},
    "duration": {f"{t} s a layer": {"layers.duration": t} for t in ("0.25", "0.5", "2.0")},
    "settled": {"settled, default limits": {"dynamics.stop": "settled"},
                "settled, limits 3 times wider": {"dynamics.stop": "settled", "dynamics.settled_energy": "3e-3", "dynamics.settled_drift": "1.5e-2"},
                "settled, limits 3 times tighter": {"dynamics.stop": "settled", "dynamics.settled_energy": "3e-4",
                                                    "dynamics.settled_drift": "1.5e-3"}},
    "layers": {"layers 0.75 times as thick": layers("thickness", 0.75), "layers twice as thick": layers("thickness", 2.0),
               "phi_0 halved": layers("fraction", 0.5), "phi_0 0.8 times": layers("fraction", 0.8)},
    "stiffness": {"E 1e7 throughout": {"particles.youngs_modulus": "1e7"},
                  **{f"E {e} in layers, hardened in 0.9 s": {"layers.youngs_modulus": e, "dynamics.relaxation": "0.9"} for e in ("3e7", "1e7", "3e6")}},
    "friction": {"friction viscous, slip time 2e-4": viscous("2e-4"), "friction viscous, slip time 1e-3": viscous("1e-3"),
                 "friction without a cap": {"contact.regularisation": "none"}},
    "window": {f"window {k}, relaxation 0.9 s": {"dynamics.window": k, "dynamics.relaxation": "0.9"} for k in ("2", "3", "5")},
    "relaxation": {f"window 3, relaxation {t} s": {"dynamics.window": "3", "dynamics.relaxation": t} for t in ("0.2", "0.5", "2.0")},
    "implicit": {f"theta {theta}, dt {dt}": {"dynamics.theta": theta, "dynamics.time_step": dt}
                 for theta, dt in (("0.5", "2e-4"), ("0.5", "5e-4"), ("1", "5e-4"), ("1", "1e-3"), ("1", "2e-3"), ("1", "5e-3"))},
    "speed": {f"inserted at {v} m/s": down(v) for v in ("0.3", "0.6", "1.0")},
}
KNOB_SCENES = {"small_on": 10, "2d_on": 10, "graded_on": 4, "tall_on": 2}   # where single knobs are turned, seeds
IMPLICIT_SCENES = {"tiny_on": 4}

def planned(options):
    """(scene, setting, options of the program, seed), the references of each scene first."""
    runs = []
    for scene, (_, changes, seeds, _) in SCENES.items():
        if scene not in options.scenes:
            continue
        wanted = options.seeds or seeds
        for seed in range(1, wanted + 1):
            for setting, values in {**({} if options.no_references else {REFERENCE: {}}),
                                    **(KNOBS["presets"] if "presets" in options.knobs and scene not in WITHOUT_PRESETS else {})}.items():
                runs.append((scene, setting, {**changes, **PAPER, **values}, seed))
        for knob in options.knobs:
            chosen = IMPLICIT_SCENES if knob == "implicit" else {name: KNOB_SCENES[name] for name in options.knob_scenes}
            if scene not in chosen:
                continue
            for setting, values in KNOBS[knob].items() if knob != "presets" else ():
                values = values(scene) if callable(values) else values
                for seed in range(1, (options.seeds or chosen[scene]) + 1):
                    runs.append((scene, setting, {**changes, **PAPER, **values}, seed))
    return runs


def coarse(profile, width, count):
    """The first `count` bins of that width of a profile, means weighted by overlap."""
    values, step = profile["values"], profile["width"]
    out = []
    for k in range(count):
        low, high, total = profile["from"] + k * width, profile["from"] + (k + 1) * width, 0.0
        for j, value in enumerate(values):
            left = profile["from"] + j * step
            total += value * max(0.0, min(high, left + step) - max(low, left))
        out.append(total / width)
    return " ".join(f"{value:.4g}" for value in out)


def curves(options, pack, height):
    """Density over height, g(r), distribution of forces, as `packmpi analyze` measures them."""
    subprocess.run([options.program, "analyze", pack], env=measuring.ENVIRONMENT, stdout=subprocess.DEVNULL, check=True)
    got = json.loads(pack.with_suffix(".analysis.json").read_text())
    vertical = got["density_profile"]["z" if "z" in got["density_profile"] else "y"]
    return {"held_coordination": got["contacts"]["held_coordination"], "profile": coarse(vertical, height / 20.0, 20),
            "g": coarse(got["pair_distribution"]["g"], 0.1, 25), "forces": coarse(got["forces"]["distribution"], 0.25, 16)}


def make(options, scene, setting, values, seed):
    """One row of the data."""
    file = SCENES[scene][0]
    folder = options.results / "runs" / f"{os.getpid()}"
    shutil.rmtree(folder, ignore_errors=True)
    words = measuring.options_of(values)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([options.program, measuring.bare_scene(file, options.results), "-q", "--force", "--seed", str(seed), "-o", folder,
                           "--set", "output.log_every=0.5", *words],
                          env=measuring.ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    row = {"commit": options.commit, "scene": scene, "setting": setting, "seed": seed, "exit": done.returncode,
           "cpu_seconds": f"{cpu:.2f}", "options": " ".join(words[1::2])}
    if done.returncode not in (0, 3):
        words = done.stderr.strip().splitlines()[-1].split(".toml: ")[-1]
        row["words"] = re.sub(r"^[0-9:]+ E |--set \S+ ", "", words)[:300]
        return row
    got = json.loads((folder / f"{file}.json").read_text())
    row["contact_evaluations"] = got["counters"]["pair_steps"]["sum"]
    layers, got, audit, asked = got["layers"], got["achieved"], got["audit"], got["target"]
    row |= {key: got[key] for key in ("particles", "height", "phi", "phi_bulk", "coordination", "rattlers", "mean_overlap", "compaction_rate", "relaxations",
                                      "particle_steps")}
    row |= {"layers": len(layers), "largest_overlap": audit["worst_overlap"], "floor_over_weight": got["floor_force"] / got["weight"],
            "kinetic_per_mgd": got["kinetic_energy"] / (got["weight"] * 2.0 * got["mean_radius"])}
    row["sunk"] = (got["height_before_relaxation"] - got["height"]) / got["height"] * len(layers) if got["relaxations"] else 0.0
    row |= curves(options, folder / f"{file}.hdf", asked["target_height"])
    return {key: f"{value:.6g}" if isinstance(value, float) else value for key, value in row.items()}


COLUMNS = ["scene", "setting", "seed", "commit", "exit", "particles", "layers", "height", "phi", "phi_bulk", "coordination", "held_coordination",
           "rattlers", "mean_overlap", "largest_overlap", "floor_over_weight", "kinetic_per_mgd", "compaction_rate", "particle_steps",
           "contact_evaluations", "cpu_seconds", "relaxations", "sunk",
           "profile", "g", "forces", "options", "words"]


def read_rows(path):
    if not path.exists():
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def add_row(options, row):
    """Puts the row into the file, which another run of this script may be filling, too."""
    path = options.data
    with open(options.results / "lock", "w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        write_rows(path, [other for other in read_rows(path) if identity(other) != identity(row)] + [row])


def write_rows(path, rows):
    order = {name: k for k, name in enumerate(SCENES)}
    rows = sorted(rows, key=lambda row: (order.get(row["scene"], 99), row["setting"], int(row["seed"])))
    fresh = path.with_suffix(".new")
    with open(fresh, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fieldnames=COLUMNS, lineterminator="\n", restval="")
        writer.writeheader()
        writer.writerows(rows)
    fresh.replace(path)


def identity(row):
    return row["scene"], row["setting"], int(row["seed"])


def commit():
    """The last commit that touched the program."""
    git = ["git", "-C", measuring.ROOT]
    last = subprocess.run([*git, "log", "-1", "--format=%h", "--", "src"], text=True, capture_output=True, check=False).stdout.strip()
    dirty = subprocess.run([*git, "status", "--porcelain", "src"], text=True, capture_output=True, check=False).stdout
    return (last or "unknown") + ("-dirty" if dirty else "")


def measure(options):
    rows = {} if options.fresh else {identity(row): row for row in read_rows(options.data)}
    todo = [(scene, setting, values, seed) for scene, setting, values, seed in planned(options)
            if rows.get((scene, setting, seed), {}).get("options") != " ".join(measuring.options_of(values)[1::2])]
    start = time.monotonic()
    for k, (scene, setting, values, seed) in enumerate(todo):
        row = make(options, scene, setting, values, seed)
        add_row(options, row)
        left = (time.monotonic() - start) / (k + 1) * (len(todo) - k - 1)
        print(f"{k + 1}/{len(todo)}, {left / 60.0:.0f} min left: {scene}, {setting}, seed {seed}: {row['cpu_seconds']} s, "
              f"{'phi_bulk ' + str(row['phi_bulk']) if 'phi_bulk' in row else row.get('words', '')}", flush=True)


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, help="seeds 1 .. N in every scene")
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--knobs", nargs="*", choices=KNOBS, default=list(KNOBS))
    parser.add_argument("--knob-scenes", nargs="+", choices=KNOB_SCENES, default=list(KNOB_SCENES), help="where single knobs are turned")
    parser.add_argument("--no-references", action="store_true", help="leave the references to another run")
    parser.add_argument("--report-only", action="store_true", help="report on the runs there are")
    parser.add_argument("--fresh", action="store_true", help="make every run again")
    parser.add_argument("--program", type=Path, default=measuring.ROOT / "build/packmpi")
    parser.add_argument("--results", type=Path, default=measuring.ROOT / "results/tradeoff")
    parser.add_argument("--doc", type=Path, default=measuring.ROOT / "doc")
    options = parser.parse_args()
    options.program, options.results = options.program.resolve(), options.results.resolve()
    options.data, options.commit = options.doc / "data/tradeoff.csv", commit()
    return options


def main():
    options = parse()
    if not options.report_only:
        measure(options)
    rows = read_rows(options.data)
    if not rows:
        sys.exit("tradeoff: no runs there")
    tradeoff_report.write(options.doc, rows, SCENES, KNOBS, REFERENCE)


if __name__ == "__main__":
    main()
