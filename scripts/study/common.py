"""What all scripts share: where the project is, MPI's environment, the package that reads packs, and how a script ends with words."""
import os
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "python"))   # import packmpi
ENVIRONMENT = {**dict(re.findall(r'^export (\w+)="\$\{\w+:-(\w+)\}"', (ROOT / "scripts" / "mpi_env.sh").read_text(), re.MULTILINE)),
               **os.environ}


def fail(words):
    sys.exit(f"{Path(sys.argv[0]).stem}: {words}")
