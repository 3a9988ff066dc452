"""The command line of the package: packmpi render|plot|report PACK, or python3 -m packmpi render|plot|report PACK."""
import sys
from importlib import import_module
from pathlib import Path

COMMANDS = {"render": "draw a pack as a picture", "plot": "plot what a pack is like", "report": "write one page on a pack, HTML"}
# Debian's package of a module.
PACKAGES = {"numpy": "python3-numpy", "h5py": "python3-h5py", "matplotlib": "python3-matplotlib", "PIL": "python3-pil",
            "vtk": "python3-vtk9", "vtkmodules": "python3-vtk9"}
USAGE, FILES = 2, 5   # exit codes, as the program's


def missing(error: ImportError) -> str:
    """What to install, for which Python, when a module could not be imported."""
    module = (error.name or str(error)).split(".")[0]
    return (f"the Python package {module} is missing for {sys.executable}; on Debian: apt-get install "
            f"{PACKAGES.get(module, 'python3-' + module)} (PACKMPI_PYTHON=/path/to/python3 takes another Python)")


def run(words: list[str]) -> str:
    """Does what the words say; what went wrong, or nothing."""
    try:
        tool = import_module(f"packmpi.{words[0]}")
        problem = import_module("packmpi.problem").Problem
    except ImportError as error:
        return missing(error)
    try:
        tool.main(words[1:])
    except problem as error:
        return str(error)
    except ImportError as error:   # VTK, which only pictures in 3D need
        return missing(error)
    return ""


def main() -> int:
    """The exit code. Problems are one line on stderr."""
    # Started by its path and not by -m, Python looks for modules in the package's own folder: not what is meant.
    folder = Path(__file__).resolve().parent
    sys.path[:] = [str(folder.parent), *(place for place in sys.path if place and Path(place).resolve() != folder)]
    words = sys.argv[1:]
    if not words or words[0] not in COMMANDS:
        print("usage: packmpi " + "|".join(COMMANDS) + " PACK [option ...]", file=sys.stderr)
        return USAGE
    said = run(words)
    if not said:
        return 0
    print(f"packmpi {words[0]}: {said}", file=sys.stderr)
    return FILES


if __name__ == "__main__":
    sys.exit(main())
