"""Runs the notebooks of doc/, each in a folder of its own: no cell may fail, and no output is kept in the repository.

usage: notebooks.py FOLDER NOTEBOOK ...
Exit code 77: nbclient or a kernel is missing (scripts/setup.sh --notebooks).
"""
import os
import shutil
import sys
import time
from pathlib import Path

os.environ["MPLBACKEND"] = "agg"
try:
    import ipykernel  # noqa: F401
    import matplotlib  # noqa: F401
    import nbformat
    from nbclient import NotebookClient
except ImportError as missing:
    print(f"skipped: the Python package {missing.name} is missing (scripts/setup.sh --notebooks)")
    sys.exit(77)


def main() -> None:
    folder = Path(sys.argv[1])
    shutil.rmtree(folder, ignore_errors=True)
    for path in map(Path, sys.argv[2:]):
        place = folder / path.stem
        place.mkdir(parents=True)
        book = nbformat.read(path, as_version=4)
        kept = [cell.id for cell in book.cells if cell.cell_type == "code" and (cell.outputs or cell.execution_count)]
        assert not kept, f"{path}: outputs are kept of {kept}"
        begun = time.monotonic()
        NotebookClient(book, timeout=240, kernel_name="python3", resources={"metadata": {"path": str(place)}}).execute()
        nbformat.write(book, place / path.name)   # to be looked at
        print(f"{path.name}: {time.monotonic() - begun:.0f} s")
        for cell in book.cells:
            if cell.cell_type == "code":
                print("".join(out.get("text", "") or out.get("data", {}).get("text/plain", "") for out in cell.outputs)[-900:])


main()
