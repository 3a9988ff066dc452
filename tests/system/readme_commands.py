#!/usr/bin/python3
"""Runs the shell commands of README.md, scaled down, in the order they stand there; and reads its scene.

usage: readme_commands.py ROOT BUILD FOLDER
Every command of a ```sh block must be listed here, and every one listed must be there. They run in a copy of the tree's
top level made of links, so that build/ is BUILD and outputs stay in FOLDER. Exit code 77: a Python package is missing.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys

SMALL = "--set layers.duration=0.01 --quiet"
# command -> what is added to make it small (or the whole of a smaller one), or why it is not run
COMMANDS = {
    "scripts/run.sh input/quickstart.toml": SMALL,
    "scripts/test.sh": "not run: this test is part of it",
    "mpirun -n 4 build/packmpi input/quickstart.toml -o results": SMALL,
    "build/packmpi check input/quickstart.toml": "",
    "build/packmpi input/quickstart.toml --seed 2 --set layers.duration=0.5 -o results/seed_2": SMALL,
    "mpirun -n 2 build/packmpi input/quickstart.toml -o night --max-steps 2000 || test $? = 75":
        ("mpirun -n 2 build/packmpi input/quickstart.toml -o night --max-steps 150 " + SMALL + " || test $? = 75"),
    "mpirun -n 3 build/packmpi input/quickstart.toml -o night --restart auto": SMALL,
    "scripts/setup.sh --render": "not run: it installs packages",
    "scripts/render.py quickstart.hdf -o quickstart.png --color contacts": "--size 200",
    "scripts/reproduce.py": "--seeds 1 --examples 5.1 --jobs 1 --set layers.duration=0.01 --doc doc_made",
}
LEAVES = ["quickstart.hdf", "quickstart.json", "quickstart.log", "quickstart.steps.csv", "results/quickstart.hdf",
          "results/seed_2/quickstart.hdf", "night/quickstart.hdf", "doc_made/reproduction.md", "doc_made/data/reproduction.csv",
          "doc_made/images/reproduction.png"]
TARGETS_MISSED = 3  # what reproduce.py says of packs that were given no time

problems = []


def blocks(text, language):
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


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
    environment = {**os.environ, "NP": "2", "BUILD": str((folder / "build").resolve())}
    text = extra if extra.startswith("mpirun") else f"{command} {extra}"
    done = subprocess.run(text, shell=True, cwd=folder, env=environment, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    allowed = (0, TARGETS_MISSED) if command == "scripts/reproduce.py" else (0,)
    print(f"$ {text}\n{done.stdout[-1500:]}")
    if done.returncode not in allowed:
        problems.append(f"exit code {done.returncode}: {command}")


def check_scene(text, root, folder):
    """The README's scene is input/quickstart.toml."""
    scene = folder / "quickstart.toml"
    scene.write_text(blocks(text, "toml")[0])
    shown, shipped = (subprocess.run([folder / "build" / "packmpi", "check", path], capture_output=True, text=True).stdout
                      for path in (scene, root / "input" / "quickstart.toml"))
    without_path = [line for line in shown.splitlines() if "is sound" not in line]
    if not without_path or without_path != [line for line in shipped.splitlines() if "is sound" not in line]:
        problems.append("the scene in README.md is not input/quickstart.toml")


def main():
    root, build, folder = (pathlib.Path(path).resolve() for path in sys.argv[1:4])
    if not has("h5py", "matplotlib"):
        print("skipped: h5py or matplotlib is missing (scripts/setup.sh --plots)")
        return 77
    text = (root / "README.md").read_text()
    commands = [line for block in blocks(text, "sh") for line in block.splitlines() if line.strip()]
    problems.extend(f"README.md has a command that is not tested: {line}" for line in commands if line not in COMMANDS)
    problems.extend(f"README.md has lost a command that is tested: {line}" for line in COMMANDS if line not in commands)
    make_tree(root, build, folder)
    can_render = has("vtk") and shutil.which("xvfb-run") is not None
    for command in commands:
        extra = COMMANDS.get(command, "not run: unknown")
        if extra.startswith("not run") or ("render.py" in command and not can_render):
            continue
        run(command, extra, folder)
    leaves = LEAVES + (["quickstart.png"] if can_render else [])
    problems.extend(f"no file {name}" for name in leaves if not (folder / name).exists())
    check_scene(text, root, folder)
    print("\n".join(problems) or f"{len(commands)} commands")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
