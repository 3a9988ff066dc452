#!/usr/bin/env python3
"""Reads the kept packs and checkpoints of every format version.

usage: run.py FOLDER -- [mpirun -n N] packmpi

NAME.pack-V.hdf and NAME.checkpoint-V.step-S.hdf are of format version V, from the scene that NAME.toml is today. A pack must be told,
analysed and converted; a checkpoint must be told and gone on with, to the digest of the pack that
this program makes of the scene from its beginning.
Without its seal each is what 0.1.0 wrote, and is refused. (How a version's files are made: doc/file_format.md.)
"""
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
DIGESTS = {"bed": "195917566c828b8c", "plane": "5cf4b296f0af02e1", "rough": "2628c854b18f4b8e"}   # of whole runs, by this program; bits of bed and plane are those of every version
RELAXATION_STEPS = {"bed": 750, "rough": 1665}   # of whole runs; some checkpoints lie in the midst of them
PARTICLES = {"bed": 18, "plane": 8, "rough": 18}
FILES = 5   # exit code: a file is damaged
failures = 0


def expect(truth: bool, words: str) -> None:
    global failures
    if not truth:
        failures += 1
        print(words, flush=True)


def call(folder: Path, command: list[str], *arguments: str) -> subprocess.CompletedProcess:
    return subprocess.run([*command, *arguments], cwd=folder, timeout=60, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


def expect_digest(folder: Path, command: list[str], pack: str, name: str, what: str) -> None:
    words = call(folder, command, "info", pack).stdout
    expect(f"digest of the particles {DIGESTS[name]}" in words, f"{what}: {DIGESTS[name]} is expected in: {words}")


def read_pack(folder: Path, command: list[str], file: Path, name: str) -> None:
    expect_digest(folder, command, file.name, name, file.name)
    done = call(folder, command[-1:], "analyze", file.name)  # it looks 2.5 diameters around: this bed is one column wide then
    expect(done.returncode == 0, f"analyze {file.name}: {done.stdout}")
    analysis = json.loads((folder / f"{file.stem}.analysis.json").read_text()) if done.returncode == 0 else {}
    expect(analysis.get("particles") == PARTICLES[name], f"analyze {file.name} counts {analysis.get('particles')}")
    for code in ("lammps", "yade", "csv"):
        done = call(folder, command, "convert", file.name, "--to", code, "--force")
        expect(done.returncode == 0, f"convert {file.name} --to {code}: {done.stdout}")


def go_on(folder: Path, command: list[str], file: Path, name: str, step: int) -> None:
    words = call(folder, command, "info", file.name).stdout
    expect("a checkpoint, valid" in words and f"step {step} " in words, f"info {file.name}: {words}")
    done = call(folder, command, "run", f"{name}.toml", "-q", "--force", "--restart", file.name)
    expect(done.returncode in (0, 3), f"run --restart {file.name}: {done.stdout}")
    expect_digest(folder, command, f"{name}.hdf", name, f"gone on from {file.name}")
    steps = json.loads((folder / f"{name}.json").read_text())["achieved"]["relaxation_steps"]
    expect(steps == RELAXATION_STEPS[name], f"gone on from {file.name}: {steps} steps of the final stage")
    other = call(folder, command, "run", f"{name}.toml", "-q", "--force", "--restart", file.name, "--set", "seed=2")
    expect(other.returncode == 6 and "seed: 1 before, 2 now" in other.stdout and "relaxation" not in other.stdout,
           f"another scene, {file.name}: code {other.returncode}, {other.stdout}")


def refuse(folder: Path, command: list[str], file: Path) -> None:
    """Without the seal: its length is the size of the tables before the last 48 bytes (doc/file_format.md)."""
    data = file.read_bytes()
    end = int.from_bytes(data[-40:-32], "little")
    (folder / "sealless.hdf").write_bytes(data[:end])
    done = call(folder, command, "info", "sealless.hdf")
    lines = [line for line in done.stdout.splitlines() if " E " in line]   # mpirun has words of its own
    expect(done.returncode == FILES and len(lines) == 1 and "no valid seal" in lines[0] and "another version" in lines[0],
           f"{file.name} without its seal: code {done.returncode}, {done.stdout}")


def main() -> int:
    if len(sys.argv) < 4 or sys.argv[2] != "--":
        sys.exit(__doc__)
    folder, command = Path(sys.argv[1]), sys.argv[3:]
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(HERE, folder)
    files = sorted(folder.glob("*.*-*.hdf"))
    for file in files:
        name, kind, step = re.fullmatch(r"(\w+)\.(pack|checkpoint)-\d+(?:\.step-(\d+))?\.hdf", file.name).groups()
        if kind == "pack":
            read_pack(folder, command, file, name)
        else:
            go_on(folder, command, file, name, int(step))
        refuse(folder, command, file)
    print(f"{len(files)} files, {failures} failures")
    return 1 if failures or len(files) < 4 else 0


if __name__ == "__main__":
    sys.exit(main())
