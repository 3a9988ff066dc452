#!/usr/bin/python3
"""Runs the shell commands of README.md and doc/*.md, block by block, scaled down; and reads the README's scene.

usage: doc_commands.py ROOT BUILD FOLDER
A block of ```sh is one shell, as a reader would paste it: its environment is that of a fresh login (nothing that this test, CTest or CI have
set for MPI), so what Open MPI needs must stand in the block. Every command must be named in COMMANDS, with what makes it small, or the
block must be marked in the text, on the line above it: <!-- not run: why -->. Every command named must be on a page. A block that was run is not
run again for another page. They run in a copy of the tree's top level made of links, so that build/ is BUILD and outputs stay in
FOLDER; NAME is quickstart. Exit code 77: a Python package is missing.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

# Too short to come to rest, which is not asked for.
SMALL = ("--set layers.duration=0.01 --set rest.wait=0 --set rest.unbalanced_force=1e9 --set rest.kinetic_energy=1e9 "
         "--set rest.support=1e9 --quiet")
# command -> what is added to make it small, or a pair: what is replaced by what in it
COMMANDS = {
    "source scripts/mpi_env.sh": "",
    "scripts/run.sh input/quickstart.toml": SMALL,
    "mpirun -n 2 build/packmpi input/quickstart.toml -o results": SMALL,
    "build/packmpi check input/quickstart.toml": "",
    "build/packmpi input/quickstart.toml --seed 2 --set layers.duration=0.5 -o results/seed_2": SMALL,
    "build/packmpi render quickstart.hdf -o quickstart.png --color contacts": "--size 200",
    "build/packmpi report quickstart.hdf": "--size 150",
    "mpirun -n 2 build/packmpi input/quickstart.toml -o night --max-steps 2000 || test $? = 75":
        ("--max-steps 2000", "--max-steps 150 " + SMALL),
    "build/packmpi input/quickstart.toml -o night --restart auto": SMALL,
    "build/packmpi check input/pebbles.toml": "",
    "mpirun -n 2 build/packmpi input/pebbles.toml": SMALL,
    "packmpi estimate input/pebbles.toml --particles 5000 --no-probe": "",
    "mpirun -n 2 build/packmpi input/hopper.toml": "--set layers.maximum=1 " + SMALL + " || test $? = 3",   # that is one layer
    "packmpi render hopper.hdf": "--size 200",
    "mpirun -n 2 build/packmpi input/tubes.toml": "--set layers.maximum=1 " + SMALL + " || test $? = 3",   # that is one layer
    "packmpi render tubes.hdf": "--size 200",
    "packmpi convert hopper.hdf --to yade": "",
    "mpirun -n 2 build/packmpi input/hopper_2d.toml": "--set layers.maximum=1 " + SMALL + " || test $? = 3",   # that is one layer
    "packmpi render hopper_2d.hdf": "--size 200",
    "packmpi plot pebbles.hdf --only radial lateral": "",
    "packmpi render pebbles.hdf --section -o section.png": "--size 200",
    "packmpi report pebbles.hdf": "--size 150",
    "packmpi analyze pebbles.hdf": "",
    "packmpi convert pebbles.hdf --to lammps": "",
    "packmpi convert pebbles.hdf --to lammps --cut input/hopper.stl:unit=mm,x=300mm,y=300mm,z=450mm -o part.data": "",
    "packmpi convert pebbles.hdf --to lammps --cut cylinder:diameter=300mm,height=400mm -o specimen.data": "",
    "scripts/study/vessels.py": "--ratios 4 --seeds 1 --document none.md --results made --set layers.duration=0.01 --set rest.wait=0 --set layers.maximum=1",
    "scripts/study/shapes.py": "--only plane --steps 0 --document none.md --results made --set layers.duration=0.01 --set rest.wait=0 --set layers.maximum=1",
    "scripts/study/vessels.py --mesh": "--seeds 1 --document none.md --results made --set layers.duration=0.01 --set rest.wait=0 --set layers.maximum=1",
    "build/packmpi check input/concrete.toml": "",
    "mpirun -n 2 build/packmpi input/concrete.toml": "--quiet",
    "packmpi convert concrete.hdf --to csv": "",
    "mpirun -n 2 build/packmpi input/quickstart.toml -o ground": SMALL,
    'mpirun -n 2 build/packmpi input/quickstart.toml -o higher --set "start.pack=$PWD/ground/quickstart.hdf" --set "container.size=[0.6, 0.6, 0.6]"': SMALL,
    "build/packmpi convert ground/quickstart.hdf --to csv --cut box:length=0.3,width=0.3,height=0.3 -o part.csv": "",
    'mpirun -n 2 build/packmpi input/quickstart.toml -o part --set "start.pack=$PWD/part.csv" --set "container.size=[0.3, 0.3, 0.5]"': SMALL,
    "scripts/study/reproduce.py": "--seeds 1 --examples 5.1 --jobs 1 --set layers.duration=0.01 --doc doc_made || test $? = 3",   # a target was missed
    "packmpi estimate input/quickstart.toml": "--no-probe",
    "packmpi estimate input/quickstart.toml --particles 100000 --ranks 8": "--no-probe",
    "packmpi estimate input/quickstart.toml --particles 100000 --floor 0.6,open --no-probe --json": "",
    "packmpi limits input/quickstart.toml": "--set layers.duration=0.01 --set dynamics.relaxation=0.01 --set rest.wait=0 --set container.size=[0.3,0.3,0.2]",
    "packmpi estimate input/quickstart.toml --set target.porosity=0.40 --no-probe": "",
    "packmpi input/quickstart.toml --set target.porosity=0.40 -o porosity":
        ("--set target.porosity=0.40", "--set target.porosity=0.6 --set target.tolerance=0.5 --set container.size=[0.3,0.3,0.2] --set dynamics.relaxation=0.01 " + SMALL),
    "packmpi check input/confined.toml": "",
    "packmpi estimate input/confined.toml --no-probe": "",
    "packmpi input/confined.toml -o specimen": "--set container.size=[0.08,0.08,0.03] --quiet",
    "packmpi input/oedometer.toml -o ring": "--set container.height=0.01 --set container.diameter=0.03 --quiet",
    "packmpi render ring/oedometer.hdf -o oedometer.png --color contacts": "--size 200",
    "packmpi input/confined.toml --set target.solid_fraction=0.62 -o filled": "--set container.size=[0.08,0.08,0.03] --set target.tolerance=0.5 --quiet",
    "packmpi input/confined.toml --set target.solid_fraction=0.62 --set 'target.state=\"confined\"' -o under": "--set container.size=[0.08,0.08,0.03] --set target.tolerance=0.5 --quiet",
    "packmpi convert specimen/confined.hdf --to lammps": "",
    "packmpi input/confined.toml --set target.solid_fraction=0.62 --set 'target.state=\"confined\"' -o triaxial":
        ("--set target.solid_fraction=0.62 --set 'target.state=\"confined\"'", "--set container.size=[0.08,0.08,0.03] --quiet"),   # with the target: -o under
    "packmpi convert triaxial/confined.hdf --to lammps": "",
    "cd triaxial": "",
    "lmp -in ../doc/lammps/compress.in -var squeeze 20000": ("-var squeeze 20000", "-var squeeze 20 -screen none"),
    "packmpi input/quickstart.toml -o handover --set rest.kinetic_energy=1e-10 --set rest.unbalanced_force=1e-4":
        ("--set rest.kinetic_energy=1e-10 --set rest.unbalanced_force=1e-4", SMALL + " --set container.size=[0.3,0.3,0.2]"),
    "packmpi convert handover/quickstart.hdf --to lammps": "",
    "packmpi convert handover/quickstart.hdf --to liggghts": "",
    "packmpi convert handover/quickstart.hdf --to yade": "",
    "cd handover": "",
    "lmp -in quickstart.lammps.in -var steps 10000": ("10000", "2 -screen none"),
    "liggghts -in quickstart.liggghts.in -var steps 10000": ("10000", "2 -screen none"),
    "PACK_STEPS=10000 yade -n -x quickstart.yade.py": ("10000", "2"),
    "lmp -in specimen/confined.lammps.in -var data specimen/confined.lammps.data -var steps 10000": ("-var steps 10000", "-var steps 10 -var holding 10 -screen none"),
    "packmpi check input/powder.toml": "",
    "packmpi estimate input/powder.toml --no-probe": "",
    "packmpi input/powder.toml -o powder": "--set container.size=[0.0003,0.0003,0.0003] --set rest.wait=0 --set layers.duration=1e-4 --set dynamics.relaxation=0 --set rest.unbalanced_force=1e9 --set rest.kinetic_energy=1e9 --set rest.support=1e9 --quiet",
    "packmpi analyze quickstart.hdf": "",
    "packmpi check input/strata.toml": "",
    "mpirun -n 2 build/packmpi input/strata.toml -o strata": "--set container.size=[0.03,0.03,0.12] --set layers.maximum=2 --set layers.thickness=0.02 " + SMALL + " || test $? = 3",
    "packmpi analyze strata/strata.hdf": "",
    "mpirun -n 2 build/packmpi input/strata.toml -o layered": "--set container.size=[0.03,0.03,0.12] --set layers.maximum=2 --set layers.thickness=0.02 " + SMALL + " || test $? = 3",
    "packmpi plot layered/strata.hdf --only composition": "",
    "packmpi render strata/strata.hdf -o strata.png --color component": "--size 200",
    "packmpi convert strata/strata.hdf --to lammps": "",
    "packmpi plot quickstart.hdf": "--only density",
    "packmpi report quickstart.hdf": "--size 150",
    "packmpi report quickstart.hdf --crate CC-BY-4.0": "--size 150",
    "packmpi convert quickstart.hdf --to lammps": "",
    "lmp -in quickstart.lammps.in": "-var steps 2 -screen none",
    "scripts/study/figures.py": "--only 4 --size 200 --images made --set layers.duration=0.01",
}
ELSEWHERE = {"doc/tutorial.md": "user_path.py"}   # the test of that page's commands
NEEDS = {"packmpi render": "vtk", "lmp ": "lmp", "liggghts -in": "liggghts", "yade -n": "yade"}       # passed over without it
LEAVES = ["quickstart.hdf", "quickstart.json", "quickstart.log", "quickstart.steps.csv", "results/quickstart.hdf",
          "results/seed_2/quickstart.hdf", "night/quickstart.hdf", "pebbles.hdf", "pebbles.analysis.json", "pebbles.radial.png", "handover/quickstart.yade.springs", "triaxial/confined.lammps.data", "pebbles.lammps.data", "specimen.data", "part.data", "hopper.hdf", "hopper_2d.hdf", "tubes.hdf", "hopper.yade.py", "concrete.hdf", "concrete.csv", "higher/quickstart.hdf", "part/quickstart.hdf", "doc_made/reproduction.md", "doc_made/data/reproduction.csv",
          "doc_made/images/reproduction.png", "quickstart.analysis.json", "quickstart.density.png",
          "quickstart.html", "ro-crate-metadata.json", "quickstart.lammps.data", "porosity/quickstart.hdf", "powder/powder.hdf", "specimen/confined.hdf", "specimen/confined.lammps.data", "made/figure_4.png"]
KEPT = ("HOME", "LANG", "LD_LIBRARY_PATH", "TMPDIR", "USER")   # of the environment; PATH is made anew

problems = []


def blocks(text, language):
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def blocks_of(text):
    """The shell blocks that are not marked, each a list of commands, and what is wrong with the marks."""
    lines, block, marked, found = text.splitlines(), None, False, []
    for before, line in zip(["", *lines], lines):
        if line == "```sh":
            block, marked = [], before.startswith("<!-- not run:")
            if marked and not re.match(r"<!-- not run: .{10,} -->$", before):
                problems.append(f"a mark that does not say why: {before}")
        elif line == "```":
            if block and not marked:
                found.append(block)
            block = None
        elif block is not None and line.strip():
            block.append(line.replace("NAME", "quickstart"))
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


def small(command):
    """The command as it is run here."""
    change = COMMANDS.get(command, "")
    return command.replace(*change) if isinstance(change, tuple) else f"{command} {change}".strip()


def environment(folder):
    """That of a fresh login, with the programs of this build and those that it needs in PATH."""
    build = (folder / "build").resolve()
    places = [str(build)] + [str(pathlib.Path(where).parent) for where in map(shutil.which, ("mpirun", "cmake", "lmp")) if where]
    return {**{name: os.environ[name] for name in KEPT if name in os.environ}, "BUILD": str(build), "PYTHONUSERBASE": str(folder / "python_user"),
            "PATH": ":".join(dict.fromkeys([*places, "/usr/bin", "/bin"]))}


def run(block, folder):
    """Runs a block's commands in one shell, which stops where one fails."""
    text = "\n".join(["set -e", *map(small, block)])
    start = time.monotonic()
    done = subprocess.run(["bash", "--noprofile", "--norc", "-c", text], cwd=folder, env=environment(folder), text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    print("\n".join(f"$ {small(command)}" for command in block) + f"\n{done.stdout[-1500:]}\n{time.monotonic() - start:.1f} s")
    if done.returncode != 0:
        problems.append(f"exit code {done.returncode}: {block}: {done.stdout[-300:]}")


def check_cleanliness(folder):
    """What the scripts set for MPI does not reach the blocks."""
    left = [name for name in environment(folder) if name.startswith(("OMPI", "PMIX", "PACKMPI"))]
    if left:
        problems.append(f"the shell is not clean: {left}")


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
    there = {page: blocks_of((root / page).read_text()) for page in pages if page not in ELSEWHERE}
    for page, test in ELSEWHERE.items():
        if page.split("/")[-1] not in (root / "tests" / "system" / test).read_text():
            problems.append(f"{test} does not speak of {page}")
    every = [block for page in there.values() for block in page]
    problems.extend(f"{page} has a command that is neither tested nor marked: {line}"
                    for page, found in there.items() for block in found for line in block if line not in COMMANDS)
    problems.extend(f"a command that is tested is on no page: {line}" for line in COMMANDS if not any(line in block for block in every))
    make_tree(root, build, folder)
    check_cleanliness(folder)
    installed = {"vtk": has("vtk") and shutil.which("xvfb-run") is not None, **{name: shutil.which(name) is not None for name in ("lmp", "liggghts", "yade")}}
    passed_over = {line for line in COMMANDS for word, what in NEEDS.items() if word in line and not installed[what]}
    for line in passed_over:
        print(f"passed over, what it needs is not installed: {line}")
    done = []
    for block in every:
        block = [line for line in block if line not in passed_over]
        if block and block not in done:
            run(block, folder)
            done.append(block)
    leaves = LEAVES + (["quickstart.png"] if installed["vtk"] else [])
    problems.extend(f"no file {name}" for name in leaves if not (folder / name).exists())
    check_scene((root / "README.md").read_text(), root, folder)
    print("\n".join(problems) or f"{len(done)} blocks, {sum(map(len, done))} commands")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
