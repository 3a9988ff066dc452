#!/usr/bin/python3
"""Runs the shell commands of README.md and doc/*.md, scaled down; and reads the README's scene.

usage: doc_commands.py ROOT BUILD FOLDER
Every command of a ```sh block must be named in COMMANDS, with what makes it small, or the block must be marked in the text, on
the line above it: <!-- not run: why -->. Every command named must be on a page. They run in a copy of the tree's top level
made of links, so that build/ is BUILD and outputs stay in FOLDER; NAME is quickstart. Exit code 77: a Python package is missing.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys

SMALL = "--set layers.duration=0.01 --quiet"
# command -> what is added to make it small (or the whole of a smaller one, if it begins like it); in the order they are run
COMMANDS = {
    "scripts/run.sh input/quickstart.toml": SMALL,
    "mpirun -n 4 build/packmpi input/quickstart.toml -o results": SMALL,
    "build/packmpi check input/quickstart.toml": "",
    "build/packmpi input/quickstart.toml --seed 2 --set layers.duration=0.5 -o results/seed_2": SMALL,
    "build/packmpi render quickstart.hdf -o quickstart.png --color contacts": "--size 200",
    "mpirun -n 2 build/packmpi input/quickstart.toml -o night --max-steps 2000 || test $? = 75":
        ("mpirun -n 2 build/packmpi input/quickstart.toml -o night --max-steps 150 " + SMALL + " || test $? = 75"),
    "mpirun -n 3 build/packmpi input/quickstart.toml -o night --restart auto": SMALL,
    "scripts/study/reproduce.py": "--seeds 1 --examples 5.1 --jobs 1 --set layers.duration=0.01 --doc doc_made",
    "packmpi estimate input/quickstart.toml": "--no-probe",
    "packmpi estimate input/quickstart.toml --particles 100000 --ranks 8": "--no-probe",
    "packmpi estimate input/quickstart.toml --particles 100000 --floor 0.6,open --no-probe --json": "",
    "packmpi analyze quickstart.hdf": "",
    "packmpi plot quickstart.hdf": "--only density",
    "build/packmpi report quickstart.hdf": "--size 150",
    "packmpi report quickstart.hdf": "--size 150",
    "packmpi convert quickstart.hdf --to lammps": "",
    "lmp -in quickstart.lammps.in": "-var steps 2 -screen none",
    "scripts/study/figures.py": "--only 4 --size 200 --images made --set layers.duration=0.01",
}
ELSEWHERE = {"doc/tutorial.md": "user_path.py"}   # the test of that page's commands
NEEDS = {"packmpi render": "vtk", "lmp ": "lmp"}       # passed over without it
LEAVES = ["quickstart.hdf", "quickstart.json", "quickstart.log", "quickstart.steps.csv", "results/quickstart.hdf",
          "results/seed_2/quickstart.hdf", "night/quickstart.hdf", "doc_made/reproduction.md", "doc_made/data/reproduction.csv",
          "doc_made/images/reproduction.png", "quickstart.analysis.json", "quickstart.density.png",
          "quickstart.html", "quickstart.lammps.data", "made/figure_4.png"]
TARGETS_MISSED = 3  # what reproduce.py says of packs that were given no time

problems = []


def blocks(text, language):
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def commands_of(text):
    """Commands of the shell blocks that are not marked, and what is wrong with the marks."""
    lines, inside, marked, found = text.splitlines(), False, False, []
    for before, line in zip(["", *lines], lines):
        if line == "```sh":
            inside, marked = True, before.startswith("<!-- not run:")
            if marked and not re.match(r"<!-- not run: .{10,} -->$", before):
                problems.append(f"a mark that does not say why: {before}")
        elif line == "```":
            inside = False
        elif inside and not marked and line.strip():
            found.append(line.replace("NAME", "quickstart"))
    return found


def has(*packages):
    code = "; ".join(f"import {name}" for name in packages)
    return subprocess.run(["/usr/bin/python3", "-c", code], capture_output=True).returncode == 0


def make_tree(root, build, folder):
    """The checkout by links; only what is written is our own."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name in ("doc", "input", "src", "include", "tests", "CMakeLists.txt", ".git"):
        if (root / name).exists():
            (folder / name).symlink_to(root / name)
    shutil.copytree(root / "scripts", folder / "scripts")
    (folder / "build").symlink_to(build)


def run(command, extra, folder):
    build = str((folder / "build").resolve())
    environment = {**os.environ, "NP": "2", "BUILD": build, "PATH": f"{build}:{os.environ['PATH']}"}
    text = extra if extra.startswith("mpirun") else f"{command} {extra}"
    done = subprocess.run(text, shell=True, cwd=folder, env=environment, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    allowed = (0, TARGETS_MISSED) if command == "scripts/study/reproduce.py" else (0,)
    print(f"$ {text}\n{done.stdout[-1500:]}")
    if done.returncode not in allowed:
        problems.append(f"exit code {done.returncode}: {command}")


def check_scene(text, root, folder):
    """The README's scene is input/quickstart.toml."""
    scene = folder / "quickstart.toml"
    scene.write_text(blocks(text, "toml")[0])
    shown, shipped = (subprocess.run([folder / "build" / "packmpi", "check", path], capture_output=True, text=True).stdout
                      for path in (scene, root / "input" / "quickstart.toml"))
    without_path = [line for line in shown.splitlines() if "is valid" not in line]
    if not without_path or without_path != [line for line in shipped.splitlines() if "is valid" not in line]:
        problems.append("the scene in README.md is not input/quickstart.toml")


def main():
    root, build, folder = (pathlib.Path(path).resolve() for path in sys.argv[1:4])
    if not has("h5py", "matplotlib"):
        print("skipped: h5py or matplotlib is missing (scripts/setup.sh --plots)")
        return 77
    pages = ["README.md", *sorted(f"doc/{path.name}" for path in (root / "doc").glob("*.md"))]
    there = {page: commands_of((root / page).read_text()) for page in pages if page not in ELSEWHERE}
    for page, test in ELSEWHERE.items():
        if page.split("/")[-1] not in (root / "tests" / "system" / test).read_text():
            problems.append(f"{test} does not speak of {page}")
    problems.extend(f"{page} has a command that is neither tested nor marked: {line}"
                    for page, lines in there.items() for line in lines if line not in COMMANDS)
    problems.extend(f"a command that is tested is on no page: {line}" for line in COMMANDS
                    if not any(line in lines for lines in there.values()))
    make_tree(root, build, folder)
    installed = {"vtk": has("vtk") and shutil.which("xvfb-run") is not None, "lmp": shutil.which("lmp") is not None}
    for command, extra in COMMANDS.items():
        needed = next((what for word, what in NEEDS.items() if word in command), None)
        if needed and not installed[needed]:
            print(f"passed over, without {needed}: {command}")
        else:
            run(command, extra, folder)
    leaves = LEAVES + (["quickstart.png"] if installed["vtk"] else [])
    problems.extend(f"no file {name}" for name in leaves if not (folder / name).exists())
    check_scene((root / "README.md").read_text(), root, folder)
    print("\n".join(problems) or f"{sum(map(len, there.values()))} commands")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
