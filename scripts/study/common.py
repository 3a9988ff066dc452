"""What all scripts share: where the project is, MPI's environment, colours, and the words a script ends with."""
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ENVIRONMENT = {**{"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",   # as scripts/mpi_env.sh
                  "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_hwloc_base_binding_policy": "none",
                  "OMPI_MCA_mpi_yield_when_idle": "1", "OMPI_MCA_btl_vader_single_copy_mechanism": "none"}, **os.environ}

INK = "#222222"
BACKGROUND = "#ffffff"
GRID = "#e5e5e5"
ACCENT = "#d1495b"  # what was asked
GOT = "#00798c"
OTHER = "#8d99ae"


def fail(words):
    sys.exit(f"{Path(sys.argv[0]).stem}: {words}")


def missing(package, option):
    fail(f"the Python package {package} is missing for {sys.executable}; install it with: scripts/setup.sh --{option}")


def pictures_of(pack, pictures, *options):
    """Draws a pack by scripts/render.py, with few colours: a third of the bytes. `pictures` are the files that must then be
    there. What went wrong, or nothing."""
    command = [sys.executable, ROOT / "scripts" / "render.py", pack, *options]
    done = subprocess.run([str(word) for word in command], text=True, capture_output=True)
    if done.returncode != 0:
        return done.stderr.strip() or f"render.py ended with code {done.returncode}"
    from PIL import Image   # comes with matplotlib
    for picture in pictures:
        Image.open(picture).quantize(200).save(picture, optimize=True)
    return ""
