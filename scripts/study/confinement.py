#!/usr/bin/python3
"""Is the stress that is asked for what comes? Three small scenes at 50, 100 and 200 kPa, vertical (K0) and isotropic: table in
doc/howto_confinement.md, doc/data/confinement.csv.

usage: scripts/study/confinement.py [--scenes NAME ...] [--stresses KPA ...] [--seed N]

All of it: some minutes of one core. Runs are remembered in results/confinement; the table has what is there.
"""
import argparse
import json
import subprocess
import time

import measuring

BASE = measuring.ROOT / "input/confined.toml"
SMALL = {"container.size": "[0.08,0.08,0.08]", "particles.youngs_modulus": "2e9"}   # 200 kPa is the most here
SIZES = {"uniform": '{ distribution = "uniform", weighting = "number", min = "4 mm", max = "6 mm" }', "equal": '{ distribution = "equal", value = "5 mm" }',
         "two": '{ distribution = "bidisperse", weighting = "mass", small = "4 mm", large = "6 mm", large_share = 0.5 }'}
# name -> (words, sizes, changes of the base)
SCENES = {
    "periodic": ("uniform 4 to 6 mm, periodic", "uniform", {}),
    "walls": ("equal, smooth walls", "equal", {"container.boundary": '["wall","wall"]', "contact.wall_friction": "0"}),
    "rolling": ("4 and 6 mm, periodic, rolling 0.1", "two", {"contact.rolling_friction": "0.1"}),
}
STATES = ("vertical", "isotropic")
COLUMNS = ["scene", "state", "stress", "particles", "stress_on_lid", "vertical", "vertical_at_rest", "lateral", "ratio", "phi_before", "phi_bulk",
           "coordination", "mean_overlap", "unbalanced_force", "confinement_steps", "steps", "code", "cpu_seconds"]


def scene_file(name, state, kpa, folder):
    """The base with its sizes and its stress; other keys are set on the command line."""
    lines = []
    for line in BASE.read_text().splitlines():
        if line.startswith("radius"):
            line = f"radius = {SIZES[SCENES[name][1]]}"
        if line.startswith("isotropic"):
            line = f'{state} = "{kpa:g} kPa"'
        lines.append(line)
    path = folder / f"{name}.toml"
    path.write_text("\n".join(lines) + "\n")
    return path


def row_of(name, state, kpa, code, seconds, summary):
    got, rest = summary["achieved"], summary["rest"]
    *lateral, vertical = got["stress_of_contacts"]
    return {"scene": name, "state": state, "stress": 1e3 * kpa, "particles": got["particles"], "stress_on_lid": got["stress_on_lid"], "vertical": vertical,
            "vertical_at_rest": got["vertical_stress_at_rest"], "lateral": sum(lateral) / len(lateral), "ratio": got["lateral_over_vertical_stress"],
            "phi_before": got["phi_bulk_before_confinement"], "phi_bulk": got["phi_bulk"], "coordination": got["coordination_without_rattlers"],
            "mean_overlap": got["mean_overlap"], "unbalanced_force": rest["unbalanced_force"]["value"], "confinement_steps": got["confinement_steps"],
            "steps": got["steps"], "code": code, "cpu_seconds": seconds}


def rows_of(options):
    for name in options.scenes:
        for state in STATES:
            for kpa in options.stresses:
                folder = options.results / f"{name}_{state}_{kpa:g}"
                folder.mkdir(parents=True, exist_ok=True)
                kept = folder / "row.json"
                if not kept.exists():
                    scene = scene_file(name, state, kpa, folder)
                    start = time.time()
                    command = [options.program, scene, "-q", "--force", "-o", folder, "--seed", options.seed, *measuring.options_of({**SMALL, **SCENES[name][2]})]
                    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, env=measuring.ENVIRONMENT, check=False)
                    if done.returncode not in (0, 3):
                        print(f"{folder.name}: code {done.returncode}: {done.stderr}", flush=True)
                        continue
                    summary = json.loads((folder / f"{name}.json").read_text())
                    kept.write_text(json.dumps(row_of(name, state, kpa, done.returncode, time.time() - start, summary)))
                row = json.loads(kept.read_text())
                print(", ".join(f"{row[key]:.5g}" if isinstance(row[key], float) else str(row[key]) for key in COLUMNS), flush=True)
                yield row


def table(rows):
    out = ["| scene | asked, kPa | on the lid | contacts, vertical (at rest) | contacts, lateral | lateral / vertical | solid fraction before, under | Z | mean overlap / r | unbalanced force | steps, of all |",
           "|---|---|---|---|---|---|---|---|---|---|---|"]
    for row in rows:
        kilo = {key: 1e-3 * row[key] for key in ("stress", "stress_on_lid", "vertical", "vertical_at_rest", "lateral")}
        out.append(f"| {SCENES[row['scene']][0]}, {row['particles']} | {kilo['stress']:g} {row['state']} | {kilo['stress_on_lid']:.2f} | {kilo['vertical']:.2f} ({kilo['vertical_at_rest']:.2f}) | "
                   f"{kilo['lateral']:.2f} | {row['ratio']:.3f} | {row['phi_before']:.4f}, {row['phi_bulk']:.4f} | {row['coordination']:.2f} | {100 * row['mean_overlap']:.2f} % | "
                   f"{row['unbalanced_force']:.1e} | {row['confinement_steps']} of {row['steps']}{' **missed**' if row['code'] else ''} |")
    met = sum(abs(row["stress_on_lid"] / row["stress"] - 1) <= 0.01 and abs(row["vertical"] - row["vertical_at_rest"]) <= 0.01 * row["stress"] for row in rows)
    return [f"On the lid and of the contacts, {met} of {len(rows)} are within 1 % of what was asked for.", "", *out]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--stresses", nargs="+", type=float, default=[50, 100, 200], metavar="KPA")
    parser.add_argument("--seed", default="1")
    parser.add_argument("--program", type=measuring.Path, default=measuring.ROOT / "build/packmpi")
    parser.add_argument("--results", type=measuring.Path, default=measuring.ROOT / "results/confinement")
    parser.add_argument("--doc", type=measuring.Path, default=measuring.ROOT / "doc")
    options = parser.parse_args()
    rows = list(rows_of(options))
    measuring.write_csv(options.doc / "data/confinement.csv", COLUMNS, rows)
    print("\n".join(table(rows)))
    measuring.write_block(options.doc / "howto_confinement.md", "confinement", "\n".join([f"{measuring.made_by('scripts/study/confinement.py')}.", "", *table(rows)]))


if __name__ == "__main__":
    main()
