#!/usr/bin/python3
"""Several components and strata, from the scene to other codes: held to numbers that are worked out here, not by the program.

usage: mixture.py FOLDER MPIRUN... -- packmpi        MPIRUN ends with the flag for the number of ranks
Three strata of two components on 1, 2 and 3 ranks, and stopped and gone on with: the same particles to the bit. Masses are exact to one
particle, boundaries within a diameter, forces those of Hertz for each pair of materials. LAMMPS, if it is there, reads and runs the types.
"""
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys

try:
    import h5py
    import numpy as np
except ImportError as error:
    print(f"skipped: the Python package {error.name} is missing (scripts/setup.sh --plots)")
    sys.exit(77)

COMMON = """
seed = 7
[container]
size = [0.16, 0.16, 0.2]
boundary = ["periodic", "wall"]
[particles]
density = 1500.0
youngs_modulus = 1.0e7
poisson_ratio = 0.25
[layers]
thickness = 0.06
fraction = 0.2
duration = 0.25
[jamming]
gravity = 2.0
[contact]
tangential = "mindlin"
friction = 0.4
[dynamics]
time_step = 5.0e-5
[rest]
wait = 0
[mixture]
share_by = "mass"
[[component]]
name = "heavy"
share = 1.0
density = 3000.0
poisson_ratio = 0.3
radius = { distribution = "equal", value = 0.009 }
[[component]]
name = "light"
share = 1.0
youngs_modulus = 5.0e6
rolling_friction = 0.1
radius = { distribution = "uniform", weighting = "mass", min = 0.006, max = 0.008 }
[[pair]]
components = ["light", "heavy"]
friction = 0.1
"""
BY_HEIGHT = COMMON + """
[[stratum]]
name = "base"
top = 0.07
shares = { heavy = 1.0 }
[[stratum]]
name = "middle"
top = 0.13
[[stratum]]
name = "cover"
shares = { heavy = 0.2, light = 0.8 }
"""
MASSES = [(2.0, [1.0, 0.0]), (1.5, [0.5, 0.5]), (1.0, [0.25, 0.75])]   # kg, shares of heavy and light
BY_MASS = COMMON.replace('friction = 0.4\n[dyn', 'friction = 0.4\ndamping_ratio = 0.0\n[dyn') + "[output]\ncontacts = true\n" + "".join(
    f"[[stratum]]\nmass = {mass}\nshares = {{ heavy = {shares[0]}, light = {shares[1]} }}\n" for mass, shares in MASSES)
DENSITY, MODULUS, POISSON = np.array([3000.0, 1500.0]), np.array([1e7, 5e6]), np.array([0.3, 0.25])
DIAMETER = 0.018

problems = []


def expect(true, words):
    if not true:
        problems.append(words)


class Program:
    def __init__(self, folder, launcher, program):
        self.folder, self.launcher, self.program = folder, launcher, program

    def run(self, ranks, *arguments, codes=(0, 3)):
        start = [*self.launcher, str(ranks)] if ranks > 1 else []
        done = subprocess.run([*start, self.program, *map(str, arguments)], cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=280)
        if done.returncode not in codes:
            sys.exit(f"{' '.join(map(str, arguments))}: exit code {done.returncode}\n{done.stdout[-3000:]}")
        return done.stdout


def rows(path):
    with h5py.File(path) as file:
        return {name: file[f"particles/{name}"][:] for name in ("id", "position", "radius", "velocity", "spin", "layer", "component")}


def same(a, b, words):
    for name in a:
        expect(a[name].shape == b[name].shape and (a[name] == b[name]).all(), f"{words}: {name} differs")


def volumes(pack):
    return 4.0 / 3.0 * math.pi * pack["radius"] ** 3


def check_heights(folder, program):
    """Strata by height; the same on any ranks and after a stop."""
    (folder / "high.toml").write_text(BY_HEIGHT)
    program.run(1, "high.toml", "-q", "-o", "one")
    pack = rows(folder / "one/high.hdf")
    for ranks in (2, 3):
        program.run(ranks, "high.toml", "-q", "-o", f"on{ranks}")
        same(pack, rows(folder / f"on{ranks}/high.hdf"), f"{ranks} ranks")
    for _ in range(9):   # stopped again and again, on other ranks
        done = program.run(2, "high.toml", "-q", "-o", "stopped", "--restart", "auto", "--max-steps", "7001", codes=(0, 3, 75))
        if (folder / "stopped/high.hdf").exists():
            break
    expect((folder / "stopped/high.hdf").exists(), f"stopped runs never came to an end: {done[-300:]}")
    same(pack, rows(folder / "stopped/high.hdf"), "stopped and gone on with")
    summary = json.loads((folder / "one/high.json").read_text())["composition"]
    mass = [one["mass"] for one in summary["components"]]
    own = [volumes(pack)[pack["component"] == k].sum() * DENSITY[k] for k in (0, 1)]
    largest = [4.0 / 3.0 * math.pi * r ** 3 * d for r, d in ((0.009, 3000.0), (0.008, 1500.0))]
    for k in (0, 1):
        expect(abs(mass[k] - own[k]) < 1e-6 * own[k], f"mass {mass[k]} of component {k} is {own[k]} by its rows")
        expect(abs(mass[k] - summary["components"][k]["target_mass"]) <= largest[k], f"component {k} is not exact to a particle")
    boundaries = summary["boundaries"]
    expect(len(boundaries) == 2, "two boundaries are expected")
    for found, wanted in zip(boundaries, (0.07, 0.13)):
        expect(found["target_height"] == wanted, f"boundary asked for at {found['target_height']}")
        expect(abs(found["height"] - wanted) < DIAMETER, f"boundary at {found['height']}, not within a diameter of {wanted}")
        print(f"boundary of {found['below']} and {found['above']}: {found['height']:.4f} m for {wanted} m, {found['mixed_depth']:.4f} m mixed")
    expect(not (pack["component"][pack["position"][:, 2] < 0.05] == 1).any(), "light particles below the boundary of the base")
    return pack


def check_masses(folder, program):
    """Strata by mass: what of each component was asked for is known beforehand."""
    (folder / "mass.toml").write_text(BY_MASS)
    program.run(2, "mass.toml", "-q")
    pack = rows(folder / "mass.hdf")
    for k in (0, 1):
        wanted = sum(mass * shares[k] for mass, shares in MASSES)
        got = (volumes(pack) * DENSITY[pack["component"]])[pack["component"] == k].sum()
        largest = (volumes(pack) * DENSITY[pack["component"]])[pack["component"] == k].max()
        print(f"component {k}: {got:.6f} kg for {wanted:.6f} kg, the largest particle has {largest:.6f} kg")
        expect(abs(got - wanted) <= 0.5 * largest * (1.0 + 1e-9), f"component {k}: {got} kg instead of {wanted} kg")
    with h5py.File(folder / "mass.hdf") as file:
        pair, overlap = file["contacts/pair"][:], file["contacts/overlap"][:]
        normal, force = file["contacts/normal"][:], file["contacts/force"][:]
    # Without damping the normal force is Hertz': 4/3 E* sqrt(r*) overlap^(3/2).
    c, r = pack["component"][pair], pack["radius"][pair]
    modulus = 1.0 / ((1.0 - POISSON[c] ** 2) / MODULUS[c]).sum(axis=1)
    expected = 4.0 / 3.0 * modulus * np.sqrt(r.prod(axis=1) / r.sum(axis=1)) * overlap ** 1.5
    found = -(force * normal).sum(axis=1)
    for kind in {tuple(sorted(row)) for row in c}:
        of = (np.sort(c, axis=1) == kind).all(axis=1) & (expected > 1e-12)
        worst = np.abs(found[of] / expected[of] - 1.0).max() if of.any() else 0.0
        print(f"contacts of {kind}: {of.sum()}, Hertz within {worst:.1e}")
        expect(worst < 1e-6, f"the force of pairs {kind} is off Hertz' by {worst}")
        friction = 0.1 if kind == (0, 1) else 0.4
        sliding = np.linalg.norm(force + found[:, None] * normal, axis=1)[of] / found[of]
        expect(sliding.max() <= friction * (1.0 + 1e-6), f"pairs {kind} bear {sliding.max()} of friction, beyond {friction}")
    expect(len({tuple(sorted(row)) for row in c}) == 3, "contacts of all three pairs are expected")


def check_exports(folder, program, pack):
    for name in ("lammps", "liggghts", "yade", "csv", "vtk"):
        program.run(1, "convert", "one/high.hdf", "--to", name, codes=(0,))
    refused = program.run(1, "convert", "one/high.hdf", "--to", "pfc", codes=(2,))
    expect("one material" in refused, f"PFC is to be refused by name: {refused}")
    lines = [line for line in (folder / "one/high.csv").read_text().splitlines() if not line.startswith("#")]
    table = np.genfromtxt(lines, delimiter=",", names=True)
    expect((table["component"] == pack["component"]).all(), "component in the CSV file")
    text = (folder / "one/high.lammps.data").read_text()
    atoms = np.array([line.split() for line in text.split("Atoms  # sphere\n\n")[1].split("\n\nVelocities")[0].splitlines()], dtype=float)
    expect("2 atom types" in text and (atoms[:, 1] == pack["component"] + 1).all(), "types in the LAMMPS file")
    expect((atoms[:, 3] == DENSITY[pack["component"]]).all(), "densities in the LAMMPS file")
    mass = (volumes(pack) * DENSITY[pack["component"]]).sum()
    for code, companion in (("lmp", "high.lammps.in"), ("liggghts", "high.liggghts.in")):
        if shutil.which(code) is None:
            print(f"{code} is not there")
            continue
        done = subprocess.run([code, "-in", companion, "-var", "steps", "500", *(["-log", "none"] if code == "lmp" else [])],
                              cwd=folder / "one", text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=200)
        said = re.findall(r"^PACK .*?(\d+) particles, volume (\S+) m3, mass (\S+) kg", done.stdout, re.MULTILINE)
        expect(done.returncode == 0 and len(said) == 2, f"{code}: {done.stdout[-1500:]}")
        for count, _, weight in said:
            expect(int(count) == len(pack["id"]), f"{code} has {count} particles")
            expect(abs(float(weight) / mass - 1.0) < 1e-5, f"{code} has {weight} kg, not {mass}")
        print(f"{code}: {said[-1:]}")


def main():
    split = sys.argv.index("--")
    folder = pathlib.Path(sys.argv[1])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    program = Program(folder, sys.argv[2:split], sys.argv[split + 1])
    pack = check_heights(folder, program)
    check_masses(folder, program)
    check_exports(folder, program, pack)
    for words in problems:
        print(words)
    return 1 if problems else 0


sys.exit(main())
