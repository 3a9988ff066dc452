#!/usr/bin/python3
"""Goes the way of doc/tutorial.md, with its files and its commands as they stand there, and looks at what comes out.

usage: user_path.py ROOT PACKMPI FOLDER
Exit code 77: h5py or matplotlib is missing. Without LAMMPS or a virtual screen their part is passed over, and the test says so.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys

try:
    import h5py
    import matplotlib  # noqa: F401
except ImportError as error:
    print(f"skipped: the Python package {error.name} is missing (scripts/setup.sh --plots)")
    sys.exit(77)

problems = []


def expect(condition, words):
    if not condition:
        problems.append(words)


def blocks(text):
    """(language, content) of every fenced block, in order."""
    return re.findall(r"^```(\w+)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def tables(text):
    """TOML tables, name -> lines; comments at the ends of lines stay."""
    found = {}
    for line in text.splitlines():
        if re.match(r"\[[\w.]+\]$", line):
            found[line] = []
        elif line and found:
            found[list(found)[-1]].append(line)
    return found


def edit(scene, text):
    """What the tutorial asks for: the radius as a new table, every other key set in its own."""
    starter = tables(scene.read_text())
    for name, lines in tables(text).items():
        expect(name in starter, f"the scene of packmpi init has no table {name}")
        if name == "[particles.radius]":
            starter[name] = lines
            continue
        keys = [line.split("=")[0].strip() for line in lines]
        kept = [line for line in starter.get(name, []) if line.split("=")[0].strip() not in keys]
        starter[name] = kept + lines
    scene.write_text("\n".join("\n".join([name, *lines, ""]) for name, lines in starter.items()))


def fresh_login(program):
    """The environment of one: nothing that CTest or CI have set for MPI, and the program's folder in PATH."""
    kept = {name: os.environ[name] for name in ("HOME", "LANG", "LD_LIBRARY_PATH", "TMPDIR", "USER") if name in os.environ}
    places = [program.parent, *(pathlib.Path(where).parent for where in map(shutil.which, ("mpirun", "lmp")) if where), "/usr/bin", "/bin"]
    return {**kept, "PATH": ":".join(map(str, places))}


def run(command, folder, environment):
    """Output of a command, or of the lines of a block, which must succeed."""
    done = subprocess.run(["bash", "--noprofile", "--norc", "-c", f"set -e\n{command}"], cwd=folder, env=environment, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    print(f"$ {command}\n{done.stdout[-1500:]}")
    if done.returncode != 0:
        sys.exit(f"exit code {done.returncode}")
    return done.stdout


def check_estimate(words, count):
    """The pack's particles are among those that packmpi estimate told."""
    found = re.search(r"^ *particles +\d+ \((\d+) to (\d+)\)$", words, re.MULTILINE)
    expect(found and int(found[1]) <= count <= int(found[2]), f"{count} particles; the estimate was {found and found[0]}")


def check_page(folder):
    """It has the pack's count, and as many images as there should be."""
    page = (folder / "gravel.html").read_text()
    drawn = page.count("data:image/svg+xml"), page.count("data:image/png")
    expect(drawn[0] == 9, f"{drawn[0]} plots on the page")
    can_draw = shutil.which("xvfb-run") and subprocess.run([sys.executable, "-c", "import vtk"], capture_output=True).returncode == 0
    expect(drawn[1] == (3 if can_draw else 1), f"{drawn[1]} pictures on the page")
    if not can_draw:
        print("passed over: pictures from outside, without VTK and a virtual screen")


def check_lammps(words, count, mass):
    """LAMMPS tells of all particles and their mass, before and after its steps."""
    said = re.findall(r"^PACK at step (\d+): (\d+) particles, volume \S+ m3, mass (\S+) kg", words, re.MULTILINE)
    expect([step for step, *_ in said] == ["0", "200"], f"LAMMPS did not run its 200 steps: {said}\n{words[-2000:]}")
    for _, there, weight in said:
        expect(int(there) == count, f"LAMMPS has {there} particles, the pack {count}")
        expect(abs(float(weight) / mass - 1.0) < 1e-12, f"LAMMPS has {weight} kg, the pack {mass}")


def main():
    root, program, folder = (pathlib.Path(path).resolve() for path in sys.argv[1:4])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "scripts").symlink_to(root / "scripts")
    environment = fresh_login(program)
    said = {}
    for language, content in blocks((root / "doc" / "tutorial.md").read_text()):
        if language == "csv":
            (folder / "gravel.csv").write_text(content)
        elif language == "toml":
            edit(folder / "gravel.toml", content)
        elif language == "sh":
            commands = content.splitlines()
            if "mpirun" in content:   # in one shell, as it is pasted: what Open MPI needs stands before it
                commands = [content.strip()]
            for command in commands:
                if command.startswith("lmp ") and not shutil.which("lmp"):
                    print("passed over: LAMMPS is not installed (scripts/setup.sh --readers)")
                    continue
                said[command] = run(command, folder, environment)
        else:
            problems.append(f"a block in {language}, of which this test knows nothing")
    with h5py.File(folder / "gravel.hdf") as pack:
        radius = pack["particles/radius"][:]
        volume = float((4.0 / 3.0 * 3.141592653589793 * radius ** 3).sum())
        reached = pack["summary"].attrs["reached"]
    expect(reached == 1 and len(radius) > 100, f"{len(radius)} particles, height reached: {reached}")
    expect(0.015 <= radius.min() and 0.025 < radius.max() <= 0.03, f"radii from {radius.min()} to {radius.max()}")
    check_page(folder)
    for command, words in said.items():
        if command.startswith("lmp "):
            check_lammps(words, len(radius), 1000.0 * volume)
        if command.startswith("packmpi estimate "):
            check_estimate(words, len(radius))
    print("\n".join(problems) or f"{len(said)} commands, {len(radius)} particles from the curve to the end")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
