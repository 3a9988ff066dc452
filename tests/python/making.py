"""packmpi in Python beside the program: the same bits, on 1, 2 and 3 ranks and on a part of them.

usage: making.py FOLDER PROGRAM MPIEXEC FLAG
The program makes one pack; then on_ranks.py and made_here.py are run by themselves. Exit code 77: a Python package is missing.
"""
import os
import shutil
import subprocess
import sys
from pathlib import Path

try:
    import h5py  # noqa: F401
    import numpy  # noqa: F401
except ImportError as missing:
    print(f"skipped: the Python package {missing.name} is missing")
    sys.exit(77)

HERE = Path(__file__).resolve().parent
SCENE = """seed = 3
[container]
size = [0.4, 0.2, 0.1]
[particles]
density = 1000.0
youngs_modulus = 1.0e7
poisson_ratio = 0.25
radius = { distribution = "uniform", min = 0.012, max = 0.02, weighting = "number" }
[layers]
thickness = 0.06
fraction = 0.15
duration = 0.1
[jamming]
gravity = 5.0
[contact]
tangential = "mindlin"
[rest]
wait = 0
[output]
contacts = true
"""


def main() -> int:
    folder, program, *launcher = sys.argv[1:]
    folder = Path(folder)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "bed.toml").write_text(SCENE)
    made = subprocess.run([program, "bed.toml", "-q"], cwd=folder, check=False, stdout=subprocess.DEVNULL)
    if made.returncode not in (0, 3):
        sys.exit(f"the program ended with {made.returncode}")
    for words in ([sys.executable, HERE / "made_here.py"], *([*launcher, str(n), sys.executable, HERE / "on_ranks.py"] for n in (1, 2, 3))):
        print("$", *map(str, words), flush=True)
        done = subprocess.run(list(map(str, words)), cwd=folder, check=False, env={**os.environ, "PACKMPI_PROGRAM": program})
        if done.returncode != 0:
            return done.returncode
    return 0


if __name__ == "__main__":
    sys.exit(main())
