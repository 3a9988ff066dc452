#!/usr/bin/python3
"""doc/slurm's scripts with a stand-in for Slurm: valid bash, options of sbatch as they are written, and what doc/howto_slurm.md says of them: an array
makes the packs of an ensemble, its table is that of the ensemble itself, a job that runs out of time is queued or submitted again and goes on.

usage: slurm.py ROOT PACKMPI FOLDER
"""
import csv
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

SCENE = """seed = 1
[container]
size = [0.3, 0.2, 0.1]
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
[rest]
wait = 0
[output]
analysis = false
"""
STAND_IN = {"srun": 'exec "$@"', "sbatch": 'echo "sbatch $*" >>asked', "scontrol": 'echo "scontrol $*" >>asked'}

problems = []


def expect(condition, words):
    if not condition:
        problems.append(words)


def run(folder, script, **environment):
    """The exit code of a script of doc/slurm, started in `folder` as sbatch does."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("SLURM")}
    done = subprocess.run(["bash", script], cwd=folder, env={**kept, "PATH": f"{folder}/bin:{os.environ['PATH']}", **environment}, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    print(f"{script} {environment}: {done.returncode}\n{done.stdout[-600:]}")
    return done.returncode


def asked(folder):
    """What the scripts have asked Slurm for since this was asked last."""
    file = folder / "asked"
    words = file.read_text().splitlines() if file.exists() else []
    file.unlink(missing_ok=True)
    return words


def rows(path):
    """Of an ensemble's table, without what depends on the clock."""
    return [{name: value for name, value in row.items() if "second" not in name} for row in csv.DictReader(path.open())]


def check_words(folder):
    for script in sorted(folder.glob("*.sh")):
        expect(subprocess.run(["bash", "-n", script], check=False).returncode == 0, f"{script.name} is no bash")
        options = [line for line in script.read_text().splitlines() if line.startswith("#SBATCH")]
        expect(len(options) > 2 and all(re.fullmatch(r"#SBATCH --[a-z-]+=\S+", line) for line in options), f"{script.name}: {options}")


def check_array(folder, packmpi):
    (folder / "bed.toml").write_text(SCENE + "[ensemble]\npacks = 3\n")
    late = run(folder, "array.sh", SLURM_ARRAY_TASK_ID="1", SLURM_ARRAY_JOB_ID="7", SLURM_JOB_END_TIME=str(int(time.time()) + 1))
    expect((late, asked(folder)) == (75, ["scontrol requeue 7_1"]), f"an element without time ends with {late}")
    for p in ("1", "2"):   # the third is lost
        code = run(folder, "array.sh", SLURM_ARRAY_TASK_ID=p, SLURM_ARRAY_JOB_ID="7")
        expect(code in (0, 3) and not asked(folder), f"element {p} ends with {code}")
    made = {path: path.stat().st_mtime_ns for path in (folder / "packs").glob("*.hdf")}
    expect(len(made) == 2, f"packs of the array: {sorted(made)}")
    expect(run(folder, "table.sh") in (0, 3), "no table")
    expect(all(path.stat().st_mtime_ns == when for path, when in made.items()), "packs that were there were made anew")
    subprocess.run([packmpi, "bed.toml", "-o", "alone", "-q"], cwd=folder, check=False, stdout=subprocess.DEVNULL)
    table = rows(folder / "packs" / "bed.ensemble.csv")
    expect(len(table) == 3 and table == rows(folder / "alone" / "bed.ensemble.csv"), f"another table than the ensemble's: {table}")


def check_chain(folder):
    (folder / "brick.toml").write_text(SCENE)
    soon = str(int(time.time()) + 1)
    expect(run(folder, "plain.sh", SLURM_JOB_END_TIME=soon) == 75, "a job without time does not end with 75")
    expect(run(folder, "resubmitting.sh", SLURM_JOB_END_TIME=soon) == 75 and asked(folder) == ["sbatch resubmitting.sh"], "it does not submit itself again")
    expect(run(folder, "resubmitting.sh") in (0, 3) and not asked(folder), "the last job of the chain")
    expect((folder / "brick" / "brick.hdf").exists(), "no pack at the end of the chain")


def main():
    root, packmpi, folder = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(root / "doc" / "slurm", folder)
    (folder / "bin").mkdir()
    (folder / "bin" / "packmpi").symlink_to(packmpi)
    for name, words in STAND_IN.items():
        (folder / "bin" / name).write_text(f"#!/bin/sh\n{words}\n")
        (folder / "bin" / name).chmod(0o755)
    check_words(folder)
    check_array(folder, packmpi)
    check_chain(folder)
    print("\n".join(problems) or "four scripts, three packs, one chain")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
