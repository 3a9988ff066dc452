"""The same spheres settle by the same law in packmpi, in LAMMPS, and in the small serial program peers/settle.cpp: for studies that compare them.

A scene is a file and changes to it, {"contact.friction": "0.5"}; one layer between periodic faces. What a run left is kept under a digest of all that it was
made from, so that a study can be stopped and continued. One process at a time, at low priority.
"""
import hashlib
import json
import math
import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np

import grains
import measuring
from packmpi import Pack

HERE = Path(__file__).resolve().parent
LAMMPS_IN = HERE / "peers/lammps/settle.in"
SERIAL = HERE / "peers/settle.cpp"
DEFAULTS = {"tangential": "sliding", "rolling_friction": 0.0, "twisting_friction": 0.0}   # of [contact]
START = {"jamming.gravity": "0", "layers.duration": "1e-5", "dynamics.time_step": "1e-5"}   # nothing moves: positions as inserted


def run(words, folder, log, any_code=False):
    """Runs a program; what it said and the CPU seconds that it took, and its exit code if any is wanted. Code 3, a missed target of packmpi, is no error."""
    before = os.times()
    with open(log, "w", encoding="utf-8") as file:
        done = subprocess.run(["nice", "-n", os.environ.get("NICE", "10"), *map(str, words)], cwd=folder, env=measuring.ENVIRONMENT, stdin=subprocess.DEVNULL, stdout=file,
                              stderr=subprocess.STDOUT, check=False)
    after, said = os.times(), Path(log).read_text(encoding="utf-8", errors="replace")
    seconds = after.children_user + after.children_system - before.children_user - before.children_system
    if any_code:
        return said, seconds, done.returncode
    if done.returncode not in (0, 3):
        sys.exit(f"{' '.join(map(str, words))}\n{said[-2000:]}\nended with {done.returncode}")
    return said, seconds


def digest(*parts):
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()[:16]


def effective(program, scene, changes):
    """The scene with every default, in SI units, by table and key."""
    done = subprocess.run([str(program), "check", str(scene), *measuring.options_of(changes)], text=True, capture_output=True,
                          env=measuring.ENVIRONMENT, check=False)
    if done.returncode != 0:
        sys.exit(done.stderr)
    values = tomllib.loads(done.stdout)
    values["contact"] = {**DEFAULTS, **values["contact"]}
    return values


class Law:
    """Stiffnesses and damping that other codes want as numbers, from a scene's values [SI]."""

    def __init__(self, values):
        self.contact, particles = values["contact"], values["particles"]
        self.modulus, self.poisson = particles["youngs_modulus"], particles["poisson_ratio"]
        self.radius = particles["radius"]["value"]
        self.mass = particles["density"] * 4.0 / 3.0 * math.pi * self.radius ** 3
        self.damping = self.contact["damping_ratio"]

    def shear_over_normal(self):
        """G* / E*, the same for pairs of like spheres and for rigid walls."""
        return (1.0 - self.poisson) / (2.0 * (2.0 - self.poisson))

    def tangential_damping(self):
        """LAMMPS' ratio of tangential to normal damping: eta_t = 2 xi sqrt(k_t m_t), m_t = 2/7 m*, over d* = 2 xi sqrt(2 E* a m*)."""
        return math.sqrt(8.0 / 7.0 * self.shear_over_normal())

    def restitution(self):
        """The argument of LAMMPS' `tsuji` that makes its coefficient this damping ratio: alpha(e) = sqrt(6) xi (Tsuji et al. 1992, a polynomial)."""
        roots = np.roots([4.8218, -18.022, 27.467, -22.348, 11.087, -4.2783, 1.2728 - math.sqrt(6.0) * self.damping])
        real = [root.real for root in roots if abs(root.imag) < 1e-9 and 0.0 <= root.real <= 1.0]
        return max(real)

    def lammps(self, wall):
        """The law as pair_coeff and fix wall/gran have it, by stiffnesses: of a wall's moduli LAMMPS makes another E* and G* than of a pair's. Rolling and
        twisting springs are constants there: that of sliding at an overlap of 5e-4 r; at rest only their limits count."""
        c, share = self.contact, 1.0 if wall else 0.5   # rigid wall, like spheres
        reduced, mass = share * self.radius, share * self.mass
        normal = share * 4.0 / 3.0 * self.modulus / (1.0 - self.poisson ** 2)
        tangential = share * 8.0 * self.modulus / (2.0 * (1.0 + self.poisson) * (2.0 - self.poisson))
        spring = tangential * math.sqrt(reduced * 5e-4 * self.radius)
        dashpot = 2.0 * self.damping * math.sqrt(spring * 2.0 / 7.0 * mass)
        friction = {"mindlin": f"mindlin_rescale/force {tangential:.12g} {self.tangential_damping():.12g} {c['friction']:.9g}",
                    "sliding": f"linear_nohistory 10 {c['friction']:.9g}"}[c["tangential"]]
        words = f"hertz {normal:.12g} {self.restitution():.15g} tangential {friction} damping tsuji"
        if c["rolling_friction"]:
            words += f" rolling sds {spring:.9g} {dashpot:.9g} {c['rolling_friction']:.9g}"
        if c["twisting_friction"]:
            words += f" twisting sds {spring * reduced ** 2:.9g} {dashpot * reduced ** 2:.9g} {c['twisting_friction'] * reduced:.9g}"
        return words + (" limit_damping" if c["tension_cutoff"] else "")


class Workshop:
    """Makes runs, and remembers them. `program`: packmpi; `results`: folder of what is remembered."""

    def __init__(self, program, results):
        self.program, self.results = Path(program).resolve(), Path(results).resolve()
        self.results.mkdir(parents=True, exist_ok=True)

    def settled(self, code, scene, changes, seed):
        """What `code` ("packmpi", "LAMMPS", "serial") left of a scene: measures (grains.py), kinetic energy over m g d, CPU seconds."""
        values = effective(self.program, scene, changes)
        law = Law(values)
        recipe, make = {"packmpi": (packmpi_recipe, self.by_packmpi), "LAMMPS": (lammps_recipe, self.by_lammps),
                        "serial": (serial_recipe, self.by_serial)}[code]
        recipe = recipe(values, law)
        kept = self.results / f"{digest(code, recipe, seed, placing(values))}.npz"
        if not kept.exists():
            folder = self.results / f"{kept.stem}.{os.getpid()}"
            folder.mkdir(exist_ok=True)
            position, radius, kinetic, seconds = make(folder, scene, changes, seed, recipe, law)
            fresh = kept.with_suffix(f".{os.getpid()}.npz")
            np.savez(fresh, position=position, radius=radius, kinetic=kinetic, seconds=seconds)
            fresh.replace(kept)
            shutil.rmtree(folder)
        with np.load(kept) as found:
            periodic = [end == "periodic" for end in values["container"]["boundary"]]
            return {**grains.measures(found["position"], found["radius"], values["container"]["size"], periodic),
                    "kinetic": float(found["kinetic"]), "cpu_seconds": float(found["seconds"])}

    def pack(self, folder, scene, changes, seed):
        """Runs packmpi; the pack file and the CPU seconds."""
        _, seconds = run([self.program, scene, "-q", "--force", "--seed", seed, "-o", folder, *measuring.options_of(changes)], folder,
                         folder / "packmpi.log")
        return folder / f"{Path(scene).stem}.hdf", seconds

    def start(self, folder, scene, changes, seed):
        """The pack file of a scene as inserted, at rest in the air."""
        placed = {key: value for key, value in changes.items() if key.split(".")[0] in ("container", "layers")}
        return self.pack(folder, scene, {**placed, **START}, seed)[0]

    def by_packmpi(self, folder, scene, changes, seed, recipe, law):
        path, seconds = self.pack(folder, scene, changes, seed)
        pack = Pack(path)
        return pack.position, pack.radius, pack.summary["kinetic_energy"] / (pack.summary["weight"] * 2.0 * law.radius), seconds

    def by_lammps(self, folder, scene, changes, seed, recipe, law):
        start = self.start(folder, scene, changes, seed)
        run([self.program, "convert", start, "--to", "lammps", "--force"], folder, folder / "convert.log")
        (folder / "settle.in").write_text(recipe["source"])
        variables = {key: value for key, value in recipe.items() if key != "source"}
        words = [word for key, value in variables.items() for word in ("-var", key, value)]
        _, seconds = run(["lmp", "-in", "settle.in", "-log", "none", "-var", "data", start.with_suffix(".lammps.data"), "-var", "out", "out.dump", *words],
                         folder, folder / "lammps.log")
        rows = np.array((folder / "out.dump").read_text().split("ITEM: ATOMS")[1].split("\n", 1)[1].split(), float).reshape(-1, 11)
        position, radius, velocity, spin = rows[:, 1:4], rows[:, 4], rows[:, 5:8], rows[:, 8:11]
        return position, radius, kinetic_per_mgd(radius, velocity, spin, recipe["gravity"]), seconds

    def by_serial(self, folder, scene, changes, seed, recipe, law):
        binary = self.results / f"settle.{digest(recipe['source'])}"
        if not binary.exists():
            run(["g++", "-std=c++17", "-O3", "-march=native", "-o", binary, SERIAL], folder, folder / "compiler.log")
        start = Pack(self.start(folder, scene, changes, seed))
        np.savetxt(folder / "in.xyzr", np.column_stack([start.position, start.radius]), "%.17g")
        options = [f"{key}={value:.17g}" for key, value in recipe.items() if key != "source"]
        said, seconds = run([binary, "in.xyzr", "out.xyzr", *options], folder, folder / "serial.log")
        rows = np.loadtxt(folder / "out.xyzr")
        return rows[:, :3], rows[:, 3], float(said.split()[-1]), seconds


def placing(values):
    """What decides where spheres are inserted, beside the seed."""
    return [values["container"], values["particles"]["radius"], *(values["layers"][key] for key in ("thickness", "fraction", "maximum"))]


def packmpi_recipe(values, law):
    """What a pack is made from. Limits of rest belong to it if the final stage waits for them."""
    idle = {"seed", "fidelity", "parallel", "checkpoint", "output", "petsc", "ensemble"} | ({"rest"} if values["rest"]["wait"] == 0.0 else set())
    contact = {key: value for key, value in values["contact"].items() if key != "restitution"}   # the damping ratio says it
    return {key: table for key, table in values.items() if key not in idle} | {"contact": contact}


def lammps_recipe(values, law):
    step = values["dynamics"]["time_step"]
    return {"source": LAMMPS_IN.read_text(), "contact": law.lammps(False), "floor": law.lammps(True), "gravity": values["jamming"]["gravity"],
            "drag": values["drag"]["coefficient"], "dt": step, "steps": round(values["layers"]["duration"] / step), "skin": 0.2 * law.radius}


def serial_recipe(values, law):
    contact, size = values["contact"], values["container"]["size"]
    if contact["tangential"] != "mindlin":
        sys.exit("peers/settle.cpp has friction with memory only")
    return {"source": SERIAL.read_text(), "width": size[0], "depth": size[1], "gravity": values["jamming"]["gravity"],
            "density": values["particles"]["density"], "modulus": law.modulus, "poisson": law.poisson, "xi": law.damping, "mu": contact["friction"],
            "rolling": contact["rolling_friction"], "twisting": contact["twisting_friction"], "drag": values["drag"]["coefficient"],
            "step": values["dynamics"]["time_step"], "duration": values["layers"]["duration"]}


def kinetic_per_mgd(radius, velocity, spin, gravity):
    """Kinetic energy of translation and rotation over the sum of m g d; the density cancels."""
    mass = radius ** 3
    energy = 0.5 * mass * (velocity ** 2).sum(axis=1) + 0.2 * mass * radius ** 2 * (spin ** 2).sum(axis=1)
    return float(energy.sum() / (mass * gravity * 2.0 * radius).sum())
