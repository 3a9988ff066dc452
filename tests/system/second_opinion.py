#!/usr/bin/python3
"""Friction with memory against a second program: some dozens of spheres fall, collide, slide and roll, and are where scripts/study/peers/settle.cpp has them.

usage: second_opinion.py SETTLE FOLDER -- mpirun ... packmpi
SETTLE is that program, written from the equations alone. Both begin with the positions that packmpi inserts and take the same steps; rounding errors
grow with each collision, so the fall is short. Exit code 77: a Python package is missing.
"""
import pathlib
import shutil
import subprocess
import sys

try:
    import h5py
    import numpy as np
except ImportError as error:
    print(f"skipped: the Python package {error.name} is missing (scripts/setup.sh --plots)")
    sys.exit(77)

STEP, DURATION = 1e-6, 0.02   # [s]
TOLERANCE = 1e-8              # of a diameter, thirty times what it is; a moment with the arm r - delta/2 is off by 1e-4, a wall too stiff by a quarter 5e-3
SCENE = """
[container]
size = [0.008, 0.008, 0.02]
boundary = [{boundary}, {boundary}]
[particles]
density = 2500
youngs_modulus = 1e8
poisson_ratio = 0.25
radius = {{ distribution = "gaussian", mean = 0.0009, sd = 0.0001, min = 0.0007, max = 0.0011, weighting = "number" }}
[layers]
thickness = 0.012
fraction = 0.25
maximum = 1
duration = {duration}
[jamming]
gravity = {gravity}
[contact]
tangential = "mindlin"
damping_ratio = 0.2
friction = 0.4
rolling_friction = {rolling}
twisting_friction = {rolling}
[dynamics]
rotation = {rotation}
time_step = {step}
[rest]
wait = 0.0   # the trajectory is compared, not the bed
"""
# name: boundary, rolling and twisting friction, rotation
CASES = {"periodic": ("periodic", 0.0, True), "walled": ("wall", 0.0, True), "rolling": ("wall", 0.1, True), "no_rotation": ("periodic", 0.0, False)}


def run(*command, codes=(0,)):
    done = subprocess.run([str(word) for word in command], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=100)
    if done.returncode not in codes:
        sys.exit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}")


def pack(program, folder, name, gravity, duration, boundary, rolling, rotation):
    """Positions and radii of what packmpi makes of a case."""
    scene = folder / f"{name}.toml"
    scene.write_text(SCENE.format(boundary=f'"{boundary}"', gravity=gravity, duration=duration, step=STEP, rolling=rolling, rotation=str(rotation).lower()))
    run(*program, scene, "-q", "-o", folder, codes=(0, 3))
    with h5py.File(folder / f"{name}.hdf") as file:
        return file["particles/position"][:], file["particles/radius"][:]


def difference(program, settle, folder, name, case):
    """Largest distance between the two programs' spheres, and how far the spheres fell, in mean diameters."""
    boundary, rolling, rotation = case
    start, radius = pack(program, folder, f"{name}_start", 0.0, STEP, *case)
    ours, _ = pack(program, folder, name, 9.81, DURATION, *case)
    np.savetxt(folder / "in.xyzr", np.column_stack([start, radius]), "%.17g")
    options = {"width": 0.008, "depth": 0.008, "xi": 0.2, "mu": 0.4, "rolling": rolling, "twisting": rolling, "rotation": int(rotation),
               "periodic": int(boundary == "periodic"), "step": STEP, "duration": DURATION}
    run(settle, folder / "in.xyzr", folder / "out.xyzr", *(f"{key}={value!r}" for key, value in options.items()))
    apart = ours - np.loadtxt(folder / "out.xyzr")[:, :3]
    if boundary == "periodic":
        apart[:, :2] -= 0.008 * np.round(apart[:, :2] / 0.008)
    return np.linalg.norm(apart, axis=1).max() / (2.0 * radius.mean()), (start - ours)[:, 2].max() / (2.0 * radius.mean())


def main():
    settle, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    program = sys.argv[sys.argv.index("--") + 1:]
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    problems = []
    for name, case in CASES.items():
        apart, fallen = difference(program, settle, folder, name, case)
        print(f"{name}: spheres fell up to {fallen:.2f} diameters and are within {apart:.1e}")
        if not (apart < TOLERANCE and fallen > 1.0):
            problems.append(name)
    if problems:
        sys.exit(f"not as the second program has it: {', '.join(problems)}")


main()
