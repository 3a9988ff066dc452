#!/usr/bin/python3
"""Converted specimens under stress stay as they are in other codes, for 10,000 steps.

usage: hold_stress.py ROOT FOLDER -- [mpirun -n N] packmpi
With springs of friction (output.contacts = true) nothing is held by a servo: stress and forces are the pack's own within 0.5 % from the first step on, in
LAMMPS, LIGGGHTS and YADE, periodic and isotropic, in the plane, and in a ring under a lid. Without them LAMMPS' servos hold the stress within 2 %.
Exit code 77: there is no LAMMPS.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

STEPS, MOST, SERVOED = 10000, 0.005, 0.02
SCENES = {"confined": ["input/confined.toml", "--set", "container.size=[0.08,0.08,0.06]"], "confined_2d": ["tests/scenes/confined_2d.toml", "--set", "rest.wait=0"],
          "oedometer": ["input/oedometer.toml", "--set", "container.height=0.012", "--set", "container.diameter=0.03"]}
SHEET = {"confined": 1.0, "confined_2d": 0.01, "oedometer": 1.0}   # m, of a mean particle: in the plane LAMMPS has forces over lengths
FORCE = re.compile(r"largest (?:contact )?force.*? (\S+) N$", re.MULTILINE)


def run(*command, folder, codes=(0,), **more):
    done = subprocess.run(command, cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **more)
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


def in_lammps(folder, name, most):
    """The stresses of the contacts between particles at the first step that counts; they stay within `most`."""
    _, *_, held = tables = rows(run("lmp", "-in", f"{name}.lammps.in", "-var", "steps", str(STEPS), "-log", f"{name}.log.lammps", folder=folder))
    assert held[-1]["Step"] - held[0]["Step"] == STEPS, "LAMMPS made other steps"
    first = tables[0][0] if most == SERVOED else held[0]   # a servo keeps what there was at step 0
    for column in (c for c in first if c.startswith("v_stress_")):
        worst = max(abs(row[column] / first[column] - 1) for row in held)
        print(f"{name} {column[2:]} in LAMMPS: {first[column]:.0f} Pa, within {100 * worst:.3f} % of it for {STEPS} steps")
        assert worst < most, f"{name}: {column} is not held"
    return {column[-1]: value / SHEET[name] for column, value in first.items() if column.startswith("v_stress_")}


def near(what, value, expected, tolerance):
    assert abs(value / expected - 1.0) < tolerance, f"{what}: {value} where the pack has {expected}"


def with_springs(folder, name, achieved):
    stress = in_lammps(folder, name, MOST)
    for axis, ours in zip("xy", achieved["stress_of_contacts"][:-1]):   # upright, floor and lid bear some; in a ring that, too
        if name != "oedometer":
            near(f"{name}, stress along {axis} in LAMMPS", stress[axis], ours, MOST)
    if shutil.which("liggghts"):
        said = run("liggghts", "-in", f"{name}.liggghts.in", "-var", "steps", str(STEPS), "-log", f"{name}.log.liggghts", folder=folder)
        bare, held = map(float, FORCE.findall(said))
        print(f"{name} in LIGGGHTS: largest force on a particle {bare:.3g} N without springs, {held:.2g} N after {STEPS} steps")
        assert held < 1e-3 * bare, f"{name}: particles are not held in LIGGGHTS"
    if shutil.which("yade"):
        said = run("yade", "-n", "-x", f"{name}.yade.py", folder=folder, env={**os.environ, "PACK_STEPS": "1000"})
        first, held = map(float, FORCE.findall(said))
        print(f"{name} in YADE: largest contact force {first:.6g} N, {held:.6g} N after 1000 steps")
        near(f"{name}, largest force in YADE", held, first, MOST)


def main():
    split = sys.argv.index("--")
    root, folder, command = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[split + 1:]
    if not shutil.which("lmp"):
        sys.exit(77)
    folder.mkdir(parents=True, exist_ok=True)
    for name, (scene, *arguments) in SCENES.items():
        run(*command, str(root / scene), *arguments, "--set", "output.contacts=true", "--force", "-q", folder=folder)
        for code in ("lammps", "liggghts", "yade"):
            said = run(command[-1], "convert", f"{name}.hdf", "--to", code, "--force", folder=folder)
            assert "springs of friction: carried over" in said, said
        with_springs(folder, name, json.loads((folder / f"{name}.json").read_text())["achieved"])
    name, (scene, *arguments) = "confined_2d", SCENES["confined_2d"]
    run(*command, str(root / scene), *arguments, "--force", "-q", folder=folder)
    assert "not carried over" in run(command[-1], "convert", f"{name}.hdf", "--to", "lammps", "--force", folder=folder)
    in_lammps(folder, name, SERVOED)


main()
