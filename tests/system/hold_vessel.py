#!/usr/bin/python3
"""Small packs at rest in vessels that are no boxes do not move in YADE: round walls by the script's own formula, a convex mesh by a facet for each face.

usage: hold_vessel.py ROOT FOLDER -- packmpi
No sphere moves by more than MOST diameters in STEPS steps. Exit code 77: there is no YADE.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys

STEPS, MOST = 300, 1e-5
SCENE = """fidelity = "balanced"
particles = {{density = 1740.0, youngs_modulus = 5e7, poisson_ratio = 0.13, diameter = {{distribution = "equal", value = "60 mm"}}}}
layers = {{thickness = 0.25, fraction = 0.18}}
jamming = {{gravity = 9.81}}
contact = {{damping_ratio = 0.3, friction = 0.3}}
output = {{contacts = true}}
rest = {{kinetic_energy = 1e-12, unbalanced_force = 1e-5}}
[container]
{}
"""
VESSELS = {"frustum": 'shape="frustum"\nbottom_diameter=0.2\ntop_diameter=0.34\nheight=0.3', "sphere": 'shape="sphere"\ndiameter=0.36\nheight=0.3',
           "annulus": 'shape="annulus"\ndiameter=0.36\ninner_diameter=0.12\nheight=0.3', "mesh": 'shape="mesh"\nfile="hopper.stl"\nunit="mm"\nheight=0.4'}


def run(*command, folder, **more):
    done = subprocess.run(command, cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **more)
    if done.returncode:
        sys.exit(f"{' '.join(command)}: code {done.returncode}\n{done.stdout[-2000:]}")
    return done.stdout


def main():
    split = sys.argv.index("--")
    root, folder, command = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[split + 1:]
    if not shutil.which("yade"):
        sys.exit(77)
    for name, vessel in VESSELS.items():
        here = folder / name
        shutil.rmtree(here, ignore_errors=True)
        here.mkdir(parents=True)
        shutil.copy(root / "input/hopper.stl", here)
        (here / "pack.toml").write_text(SCENE.format(vessel))
        run(*command, "pack.toml", "-q", folder=here)
        said = run(*command, "convert", "pack.hdf", "--to", "yade", folder=here)
        assert "springs of friction: carried over as forces" in said, said
        said = run("yade", "-n", "-x", "pack.yade.py", folder=here, env={**os.environ, "PACK_STEPS": str(STEPS)})
        far = float(re.search(r"DRIFT the farthest particle has moved by (\S+) mean diameters", said)[1])
        print(f"{name}: {re.search(r'PACK after .*?: (.*?),', said)[1]}, the farthest by {far:.2g} d in {STEPS} steps")
        assert far < MOST, f"{name}: a pack at rest moves by {far} diameters"


main()
