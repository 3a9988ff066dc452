#!/usr/bin/python3
"""Reference specimens: packs that anybody can make again to the bit. Makes them, and writes their digests into doc/specimens.md.

usage: scripts/study/specimens.py [--check] [--only quickstart ...] [--ranks 1 2] [--program build/packmpi]

--check compares with the page instead, and ends with code 1 where a digest differs. A minute of one core.
"""
import argparse
import re
import subprocess
import sys
from pathlib import Path

import common
import measuring

# name -> scene of input/, what is changed in it, what it is
SPECIMENS = {
    "quickstart": ("quickstart", {}, "equal spheres between walls, friction 0.2"),
    "specimen": ("confined", {"container.size": "[0.08,0.08,0.08]"}, "spheres of 8 to 12 mm under 100 kPa on all sides, periodic"),
    "powder": ("powder", {"fidelity": '"draft"'}, "lognormal powder of 40 to 80 µm, periodic"),
}


def make(options, name, ranks):
    """Particles, solid fraction and digest of one pack."""
    scene, changes, _ = SPECIMENS[name]
    folder = options.results / f"{name}_{ranks}"
    folder.mkdir(parents=True, exist_ok=True)
    command = ["mpirun", "-n", ranks, options.program, common.ROOT / f"input/{scene}.toml", "-q", "--force", "-o", folder, *measuring.options_of(changes)]
    for words in (command, [options.program, "info", folder / f"{scene}.hdf"]):
        done = subprocess.run([str(word) for word in words], env=common.ENVIRONMENT, text=True, capture_output=True, check=False)
        if done.returncode != 0:
            common.fail(f"{name} on {ranks} ranks: code {done.returncode}: {done.stderr}")
    from packmpi import Pack   # h5py, which --help needs not
    pack = Pack(folder / f"{scene}.hdf")
    return pack.count, f"{pack.phi_bulk:.6f}", re.search(r"digest of the particles (\w+)", done.stdout)[1]


def row(name, found):
    scene, changes, words = SPECIMENS[name]
    command = " ".join([f"`packmpi input/{scene}.toml", *(f"--set '{key}={value}'" for key, value in changes.items())]) + "`"
    return f"| {name}: {words} | {command} | {found[0]} | {found[1]} | `{found[2]}` |"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--only", nargs="+", choices=SPECIMENS, default=SPECIMENS, metavar="NAME", help="default: all")
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--program", type=lambda text: Path(text).resolve(), default=common.ROOT / "build/packmpi")
    parser.add_argument("--results", type=lambda text: Path(text).resolve(), default=common.ROOT / "results/specimens")
    options = parser.parse_args()
    page = common.ROOT / "doc/specimens.md"
    rows = []
    for name in options.only:
        found = {make(options, name, ranks) for ranks in options.ranks}
        if len(found) > 1:
            common.fail(f"{name} is not the same on {options.ranks} ranks: {found}")
        rows.append(row(name, found.pop()))
        print(rows[-1], flush=True)
    if options.check:
        other = [line for line in rows if line not in page.read_text().splitlines()]
        print("\n".join(["doc/specimens.md has other digests than:", *other]) if other else f"{len(rows)} specimens are those of doc/specimens.md")
        sys.exit(bool(other))
    text = "\n".join([f"{measuring.made_by('scripts/study/specimens.py')}, on {' and '.join(map(str, options.ranks))} ranks.", "",
                      "| specimen | command | particles | phi_bulk | digest of the particles |", "|---|---|---|---|---|", *rows])
    measuring.write_block(page, "specimens", text)


if __name__ == "__main__":
    main()
