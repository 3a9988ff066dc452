#!/usr/bin/python3
"""The programs that packs are converted for read them: LAMMPS, LIGGGHTS, YADE, VTK.

usage: convert_programs.py ROOT FOLDER -- mpirun ... packmpi
A small pack in 3D, one in 2D and one in a cylinder are converted; each program reads them, runs some steps by the in-file that came with
them, and tells count, volume, mass and largest contact force, which are compared with the pack's own. A program that is
not installed is passed over; exit code 77 if none is there (scripts/setup.sh --peers).
"""
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

SMALL = ["--set", "layers.maximum=2", "--set", "rest.wait=0", "--set", "output.contacts=true", "--quiet"]
AS_THE_OTHERS = ["particles.density=1000", "particles.youngs_modulus=1e8", "particles.poisson_ratio=0.25", "contact.damping_ratio=0.1"]
SCENES = {"quickstart": ["--set", "container.size=[0.3, 0.3, 0.45]", "--set", "layers.duration=0.4"],
          "paper_5_1": ["--set", "container.size=[0.4, 0.5]", "--set", "layers.duration=0.4"],
          "pebbles": [word for one in AS_THE_OTHERS for word in ("--set", one)] + ["--set", "layers.duration=0.4", "--set", "dynamics.relaxation=0", "--set", "dynamics.window=0"]}   # they still move: velocities are carried, not springs
SAID = re.compile(r"^PACK .*?(\d+) particles, volume (\S+) m3, mass (\S+) kg, largest (?:contact )?force.*? (\S+) N$",
                  re.MULTILINE)

problems = []


def near(what, value, expected, tolerance):
    if not abs(value - expected) <= tolerance * abs(expected):
        problems.append(f"{what}: {value!r} instead of {expected!r}")


def run(*command, folder, codes=(0,)):
    done = subprocess.run([str(word) for word in command], cwd=folder, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, timeout=110)
    if done.returncode not in codes:
        sys.exit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}")
    return done.stdout


def floor_force(height, radius, upward, density):
    """What a rigid floor carries by the law of the scenes: Hertz, E 1e8, nu 0.25, damping ratio 0.1, no pull."""
    modulus = 1e8 / (1.0 - 0.25 ** 2)
    depth = np.maximum(radius - height, 0.0)
    stiffness = np.sqrt(radius * depth) * modulus
    damping = 2.0 * 0.1 * np.sqrt(2.0 * stiffness * density * 4.0 / 3.0 * math.pi * radius ** 3)
    return math.fsum(np.maximum(4.0 / 3.0 * stiffness * depth - damping * upward, 0.0))


class Pack:
    """Its own numbers."""

    def __init__(self, path, density=1000.0):
        with h5py.File(path) as file:
            vertical = file["summary"].attrs["dimension"] - 1
            radius, x = file["particles/radius"][:], file["particles/position"][:]
            self.count, self.volume = len(radius), math.fsum(4.0 / 3.0 * math.pi * radius ** 3)
            self.mass = density * self.volume
            pair, force = file["contacts/pair"][:], file["contacts/force"][:]
            branch = x[pair[:, 1]] - x[pair[:, 0]]
            normal = branch / np.linalg.norm(branch, axis=1)[:, None]
            self.largest = float((-(force * normal).sum(axis=1)).max())
            self.floor = floor_force(x[:, vertical], radius, file["particles/velocity"][:, vertical], density)


def check(program, words, pack, tolerances):
    """`tolerances` of the largest force: before the first step, and none for what comes later but that it is there."""
    said = SAID.findall(words)
    if len(said) != 2:
        problems.append(f"{program} said {said} in\n{words}")
        return
    for count, volume, mass, _ in said:
        near(f"{program}, count", int(count), pack.count, 0.0)
        near(f"{program}, volume", float(volume), pack.volume, 1e-12)
        near(f"{program}, mass", float(mass), pack.mass, 1e-12)
    if tolerances is not None:
        near(f"{program}, largest contact force", float(said[0][3]), pack.largest, tolerances)
    if not 0.0 < float(said[1][3]) < 10.0 * pack.largest:
        problems.append(f"{program}: the pack burst or fell apart: {said[1][3]} N after the steps")


def check_floor(name, pack, here):
    """The floor carries in LAMMPS what it carries in the pack: the force on all without weight, drag and sides."""
    text = (here / f"{name}.lammps.in").read_text()
    vertical = "y" if name == "paper_5_1" else "z"
    text = re.sub(r"(?m)^fix +(gravity|drag|wall_\w+) .*\n", "", text)
    measure = f"variable push atom f{vertical}\ncompute push all reduce sum v_push\nvariable push_now equal c_push\nthermo_style custom step c_volume c_strongest c_farthest c_apart c_push\n"
    text = text.replace("run             ${steps}", measure + "run ${steps}") + 'print "FLOOR $(v_push_now:%.17g)"\n'
    (here / "floor.in").write_text(text)
    run("lmp", "-in", "floor.in", "-var", "steps", "0", "-screen", "none", "-log", "floor.log", folder=here)
    near(f"LAMMPS, force on the floor, {name}", float(re.findall(r"(?m)^FLOOR (\S+)", (here / "floor.log").read_text())[-1]), pack.floor, 1e-9)


def vtk_points(path, reader):
    """Points as VTK counts them, or None without VTK."""
    code = f"import vtk; r = vtk.{reader}(); r.SetFileName({str(path)!r}); r.Update(); print(r.GetOutput().GetNumberOfPoints())"
    done = subprocess.run(["/usr/bin/python3", "-c", code], text=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    return int(done.stdout.split()[-1]) if done.returncode == 0 and done.stdout.strip() else None


def main():
    root, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    program = sys.argv[sys.argv.index("--") + 1:]
    tried = []
    for name, change in SCENES.items():
        here = folder / name
        shutil.rmtree(here, ignore_errors=True)
        here.mkdir(parents=True)
        run(*program, root / "input" / f"{name}.toml", "-o", here, *SMALL, *change, folder=here, codes=(0, 3))
        pack = Pack(here / f"{name}.hdf")
        plane = name == "paper_5_1"
        for form in ("lammps", "liggghts", "yade", "vtk"):
            run(*program, "convert", here / f"{name}.hdf", "--to", form, folder=here)
        if shutil.which("lmp"):
            run("lmp", "-in", f"{name}.lammps.in", "-screen", "none", "-log", "lammps.log", folder=here)
            check(f"LAMMPS, {name}", (here / "lammps.log").read_text(), pack, 1e-9)   # the same law
            check_floor(name, pack, here)
            tried.append("LAMMPS")
        if shutil.which("liggghts"):
            check(f"LIGGGHTS, {name}", run("liggghts", "-in", f"{name}.liggghts.in", folder=here), pack, None)
            tried.append("LIGGGHTS")
        if shutil.which("yade") and not plane:
            check(f"YADE, {name}", run("yade", "-n", "-x", f"{name}.yade.py", folder=here), pack, 0.2)   # Mindlin, a step later
            tried.append("YADE")
        for path, reader in ((here / f"{name}.vtp", "vtkXMLPolyDataReader"), (here / f"{name}.hdf", "vtkHDFReader")):
            points = vtk_points(path, reader)
            if points is not None:
                near(f"{reader}, {name}", points, pack.count, 0.0)
                tried.append(reader)
    print("read by", ", ".join(sorted(set(tried))) or "nobody: nothing is installed")
    if problems:
        sys.exit("\n".join(problems))
    sys.exit(0 if tried else 77)


main()
