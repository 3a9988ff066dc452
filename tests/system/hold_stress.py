#!/usr/bin/python3
"""LAMMPS holds the converted specimens at their stress: periodic and isotropic, and in the plane, within 2 % for 10,000 steps.

usage: hold_stress.py ROOT FOLDER -- [mpirun -n N] packmpi
Exit code 77: there is no LAMMPS.
"""
import json
import pathlib
import shutil
import subprocess
import sys

STEPS, MOST = 10000, 0.02
SCENES = {"confined": ["input/confined.toml", "--set", "container.size=[0.08,0.08,0.05]"], "confined_2d": ["tests/scenes/confined_2d.toml", "--set", "rest.wait=0"]}


def run(*command, folder, codes=(0,)):
    done = subprocess.run(command, cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode not in codes:
        sys.exit(f"{' '.join(command)}: code {done.returncode}\n{done.stdout[-2000:]}")
    return done.stdout


def rows(text):
    """The table of each run: lists of {column: number}."""
    tables = []
    for line in text.splitlines():
        words = line.split()
        if words[:1] == ["Step"]:
            tables.append((words, []))
        elif tables and len(words) == len(tables[-1][0]) and words[0].isdigit():
            tables[-1][1].append(dict(zip(tables[-1][0], map(float, words))))
    return [table for _, table in tables]


def main():
    split = sys.argv.index("--")
    root, folder, command = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[split + 1:]
    if not shutil.which("lmp"):
        sys.exit(77)
    folder.mkdir(parents=True, exist_ok=True)
    for name, (scene, *arguments) in SCENES.items():
        run(*command, str(root / scene), *arguments, "--force", "-q", folder=folder)
        run(command[-1], "convert", f"{name}.hdf", "--to", "lammps", "--force", folder=folder)
        said = run("lmp", "-in", f"{name}.lammps.in", "-var", "steps", str(STEPS), "-log", f"{name}.log.lammps", folder=folder)
        first, *_, held = rows(said)
        achieved = json.loads((folder / f"{name}.json").read_text())["achieved"]
        assert held[-1]["Step"] - held[0]["Step"] == STEPS, "LAMMPS made other steps"
        for column in (c for c in held[0] if c.startswith("v_stress_")):
            worst = max(abs(row[column] / first[0][column] - 1) for row in held)
            print(f"{name} {column[2:]}: {first[0][column]:.0f} Pa at step 0, within {100 * worst:.2f} % of it for {STEPS} steps")
            assert worst < MOST, f"{name}: {column} is not held"
        # Of the contacts between particles alone: those with floor and lid bear the rest of the vertical stress.
        sheet = 0.01 if name.endswith("2d") else 1.0   # m, of a mean particle: in the plane LAMMPS has forces over lengths
        for axis, ours in zip("xy", achieved["stress_of_contacts"][:-1]):
            theirs = first[0][f"v_stress_{axis}"] / sheet
            assert abs(theirs / ours - 1) < 0.08, f"{name}: {theirs} Pa by LAMMPS, {ours} Pa by packmpi, without its springs"


main()
