#!/usr/bin/python3
"""Is a density that is asked for what comes out, and even over the height? Scenes by four targets between their limits: table in doc/howto_porosity.md,
doc/data/targets.csv.

usage: scripts/study/targets.py [--scenes NAME ...] [--shares S ...] [--seed N] [--set KEY=VALUE ...]

All scenes: about an hour of one core. Runs are remembered in results/targets; the table has what is there.
"""
import argparse
import json
import subprocess
import time

import measuring

BASE = measuring.ROOT / "scripts/study/targets.toml"
WALLS = {"container.boundary": '["wall","wall"]'}
ROLLING = {"contact.rolling_friction": "0.2", "contact.twisting_friction": "0.1"}
GRADED = {"particles.radius.distribution": "uniform", "particles.radius.weighting": "number", "particles.radius.min": "0.007",
          "particles.radius.max": "0.013"}
BIDISPERSE = {"particles.radius.distribution": "bidisperse", "particles.radius.weighting": "mass", "particles.radius.small": "0.008",
              "particles.radius.large": "0.016", "particles.radius.large_share": "0.5"}
MIDDLE = {"container.size": "[0.34,0.34,0.44]"}
LARGE = {"container.size": "[0.8,0.8,1.28]", "dynamics.window": "4"}
# name -> (words, changes of the base). The last four were chosen once the code was finished.
SCENES = {
    "equal": ("equal, periodic", {}),
    "equal_walls": ("equal, walls", WALLS),
    "graded": ("uniform 7 to 13 mm, periodic", GRADED),
    "bidisperse_walls": ("8 and 16 mm, walls", {**BIDISPERSE, **WALLS}),
    "equal_rolling": ("equal, periodic, rolling 0.2", ROLLING),
    "middle": ("equal, periodic", MIDDLE),
    "middle_walls": ("equal, walls", {**MIDDLE, **WALLS}),
    "middle_bidisperse": ("8 and 16 mm, periodic", {**MIDDLE, **BIDISPERSE}),
    "late_smooth": ("equal, walls, friction 0.3, 30 MPa", {**WALLS, "contact.friction": "0.3", "particles.youngs_modulus": "3e7"}),
    "late_graded_rolling": ("uniform 7 to 13 mm, walls, rolling 0.2", {**GRADED, **WALLS, **ROLLING}),
    "late_middle_thin": ("equal, walls, thin layers, window", {**MIDDLE, **WALLS, "layers.thickness": "0.08", "layers.duration": "0.25",
                                                                "dynamics.window": "6"}),
    "large": ("equal, periodic, window", LARGE),
}
SHARES = [0.1, 0.37, 0.63, 0.9]   # of the way from the loosest to the densest
COLUMNS = ["scene", "spheres", "loosest", "densest", "target", "phi_bulk", "coordination", "fifths", "friction_first", "friction_last", "code", "cpu_seconds"]


def scene_file(name, changes, folder):
    """The base with a size distribution of its own; other keys are set on the command line."""
    sizes = {key.split(".")[-1]: value for key, value in changes.items() if key.startswith("particles.radius.")}
    text = BASE.read_text()
    if sizes:
        words = ", ".join(f'{key} = "{value}"' if value[0].isalpha() else f"{key} = {value}" for key, value in sizes.items())
        text = "\n".join(f"radius = {{ {words} }}" if line.startswith("radius") else line for line in text.splitlines()) + "\n"
    path = folder / f"{name}.toml"
    path.write_text(text)
    return path, {key: value for key, value in changes.items() if not key.startswith("particles.radius.")}


def run(command):
    start = time.time()
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, env=measuring.ENVIRONMENT, check=False)
    return done.returncode, done.stdout, done.stderr, time.time() - start


def limits_of(options, path, changes):
    """Loosest and densest solid fraction."""
    kept = path.with_suffix(".limits.json")
    if not kept.exists():
        code, out, err, _ = run([options.program, "limits", path, "--json", *measuring.options_of(changes)])
        if code != 0:
            raise SystemExit(f"{path}: {err}")
        kept.write_text(out)
    found = json.loads(kept.read_text())
    return found["loosest"]["phi_bulk"], found["densest"]["phi_bulk"]


def fifths(pack):
    """The largest less the smallest solid fraction of five equal parts of the height, floor and surface left out."""
    from packmpi import Pack
    read = Pack(pack)
    d = 2.0 * float(read.radius.mean())
    low, high = 2.0 * d, min(read.summary["height"], float(read.size[-1])) - 3.0 * d
    area = float(read.size[0] * read.size[1])
    below = [measuring.solid_below(low + k * (high - low) / 5.0, read.position[:, 2], read.radius) for k in range(6)]
    parts = [(b - a) / (area * (high - low) / 5.0) for a, b in zip(below, below[1:])]
    return max(parts) - min(parts)


def rows_of(options):
    options.results.mkdir(parents=True, exist_ok=True)
    more = dict(change.split("=", 1) for change in options.set)
    for name in options.scenes:
        path, changes = scene_file(name, {**SCENES[name][1], **more}, options.results)
        loosest, densest = limits_of(options, path, changes)
        for share in options.shares:
            target = round(loosest + share * (densest - loosest), 4)
            folder = options.results / f"{name}_{target}"
            kept = folder / "row.json"
            if not kept.exists():
                command = [options.program, path, "-q", "--force", "-o", folder, "--seed", options.seed,
                           *measuring.options_of({**changes, "target.solid_fraction": str(target)})]
                code, _, err, seconds = run(command)
                if code not in (0, 3):
                    print(f"{name} {target}: code {code}: {err}", flush=True)
                    continue
                summary = json.loads((folder / f"{name}.json").read_text())
                friction = [layer["filling_friction"] for layer in summary["layers"]]
                got = summary["achieved"]
                row = {"scene": name, "spheres": got["particles"], "loosest": loosest, "densest": densest, "target": target,
                       "phi_bulk": got["phi_bulk"], "coordination": got["coordination"], "fifths": fifths(folder / f"{name}.hdf"),
                       "friction_first": friction[0], "friction_last": friction[-1], "code": code, "cpu_seconds": seconds}
                kept.write_text(json.dumps(row))
                (folder / f"{name}.hdf").unlink()
            row = json.loads(kept.read_text())
            print(", ".join(f"{row[key]:.5g}" if isinstance(row[key], float) else str(row[key]) for key in COLUMNS), flush=True)
            yield row


def table(rows):
    out = ["| scene | spheres | loosest | densest | target | solid fraction | off | fifths | Z | friction while filling, first and last layer |",
           "|---|---|---|---|---|---|---|---|---|---|"]
    for row in rows:
        off = row["phi_bulk"] - row["target"]
        out.append(f"| {SCENES[row['scene']][0]} | {row['spheres']} | {row['loosest']:.4f} | {row['densest']:.4f} | {row['target']:.4f} | "
                   f"{row['phi_bulk']:.4f} | {off:+.4f}{' **missed**' if abs(off) > 0.002 else ''} | {row['fifths']:.4f} | {row['coordination']:.2f} | "
                   f"{row['friction_first']:.3g}, {row['friction_last']:.3g} |")
    met = sum(abs(row["phi_bulk"] - row["target"]) <= 0.002 for row in rows)
    even = sum(row["fifths"] <= 0.004 for row in rows)
    return [f"{met} of {len(rows)} are within 0.002 of the target; the fifths of {even} are within 0.004 of each other.", "", *out]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--shares", nargs="+", type=float, default=SHARES)
    parser.add_argument("--seed", default="1")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="change the scenes")
    parser.add_argument("--program", type=measuring.Path, default=measuring.ROOT / "build/packmpi")
    parser.add_argument("--results", type=measuring.Path, default=measuring.ROOT / "results/targets")
    parser.add_argument("--doc", type=measuring.Path, default=measuring.ROOT / "doc")
    options = parser.parse_args()
    rows = list(rows_of(options))
    measuring.write_csv(options.doc / "data/targets.csv", COLUMNS, rows)
    print("\n".join(table(rows)))
    measuring.write_block(options.doc / "howto_porosity.md", "targets", "\n".join([f"{measuring.made_by('scripts/study/targets.py')}.", "", *table(rows)]))


if __name__ == "__main__":
    main()
