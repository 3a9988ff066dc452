#!/usr/bin/env python3
"""Runs every scene of this folder and holds it to what its first lines expect.

usage: run.py FOLDER [-k PART] -- [mpirun -n N] packmpi       runs them in FOLDER; those whose names contain PART
       run.py FOLDER --table OLD NEW [-k PART]                digests of the packs that two programs make, as Markdown;
                                                              of the paper's scenes, too, cut to two layers

The corpus is of the paper's law, friction by "stop", and packs are as they are after their last layer.

A scene begins with comments, of which these are read:
  # with: ARGUMENTS                  more arguments of the command line
  # expect: digest HEX               what `packmpi info` prints of the pack; the exit code is 0 or 3
  # expect: code N                   the exit code
  # expect: says "TEXT"              in what is printed on the screen
  # expect: KEY NUMBER +- TOLERANCE  in NAME.json; KEY is a path such as achieved.phi_bulk
"""
import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
# Of the programs before 0.2.0, for --table.
FORMER_KEYS = {"relaxation = ": "thaw = ", 'tangential = "sliding"\n': ""}
NEW_KINDS = ('tangential = "mindlin"', 'region = "container"')   # scenes that they cannot make
NEW_KEYS = ("rest.",)
PAPER = ["--set", "layers.maximum=2", "--set", "rest.wait=0"]   # the last of its packs: no stage after the layers


def head(scene: Path, word: str) -> list[str]:
    """What follows `# word:` in the comments of a scene."""
    return re.findall(rf"^# {word}: (.*)$", scene.read_text(), re.MULTILINE)


class Run:
    """One scene in a folder of its own, made by `command`."""

    def __init__(self, scene: Path, text: str, folder: Path, command: list[str], arguments: list[str]):
        self.folder = folder
        self.pack = folder / f"{scene.stem}.hdf"
        self.command = command
        folder.mkdir(parents=True, exist_ok=True)
        for old in folder.iterdir():
            old.unlink()
        (folder / scene.name).write_text(text)
        done = self.call(command, "run", scene.name, "-q", *arguments)
        self.code, self.words = done.returncode, done.stdout

    def call(self, command: list[str], *arguments: str) -> subprocess.CompletedProcess:
        return subprocess.run([*command, *arguments], cwd=self.folder, timeout=600, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

    def digest(self) -> str:
        """Of the pack; empty if there is none."""
        alone = [self.command[-1]]   # no mpirun: it costs more than the work
        found = re.search(r"digest of the particles ([0-9a-f]{16})", self.call(alone, "info", self.pack.name).stdout)
        return found.group(1) if found else ""

    def number(self, path: str):
        value = json.loads(self.pack.with_suffix(".json").read_text())
        for key in path.split("."):
            value = value[key]
        return value


def flaw(run: Run, expected: str) -> str:
    """What is wrong with a run, in words; empty if it is as expected."""
    kind, _, rest = expected.partition(" ")
    if kind == "digest":
        found = run.digest() if run.code in (0, 3) else f"code {run.code}: {run.words[-300:]}"
        return "" if found == rest else f"digest {rest} is expected, not {found}"
    if kind == "code":
        return "" if run.code == int(rest) else f"code {rest} is expected, not {run.code}: {run.words[-300:]}"
    if kind == "says":
        text = json.loads(rest)
        return "" if text in run.words else f'"{text}" is expected in: {run.words[-500:]}'
    number, tolerance = (float(part) for part in rest.split(" +- "))
    found = run.number(kind)
    return "" if abs(found - number) <= tolerance else f"{kind} {rest} is expected, not {found}"


def check(folder: Path, part: str, command: list[str]) -> int:
    scenes = [scene for scene in sorted(HERE.glob("*.toml")) if part in scene.stem]
    failures = 0
    for scene in scenes:
        run = Run(scene, scene.read_text(), folder / scene.stem, command, with_arguments(scene))
        expectations = head(scene, "expect")
        flaws = [words for words in (flaw(run, expected) for expected in expectations) if words]
        if not expectations:
            flaws = ["nothing is expected of it"]
        for words in flaws:
            print(f"{scene.name}: {words}", flush=True)
        failures += bool(flaws)
    print(f"{len(scenes)} scenes, {failures} not as expected")
    return 1 if failures or not scenes else 0


def with_arguments(scene: Path) -> list[str]:
    return shlex.split(" ".join(head(scene, "with")))


def without_new_keys(arguments: list[str]) -> list[str]:
    """Pairs of --set and an assignment, those that the former program knows."""
    pairs = zip(arguments[::2], arguments[1::2])
    return [word for pair in pairs if not pair[1].startswith(NEW_KEYS) for word in pair]


def table(folder: Path, old: str, new: str, part: str) -> int:
    print("| scene | before | after | |\n|---|---|---|---|")
    different = 0
    paper = sorted((HERE.parents[1] / "input").glob("paper_5_*.toml"))
    kinds = [scene for scene in sorted(HERE.glob("*.toml")) if any(words.startswith("digest") for words in head(scene, "expect"))
             and not any(key in scene.read_text() for key in NEW_KINDS)]
    for scene in [scene for scene in paper + kinds if part in scene.stem]:
        arguments = PAPER if scene in paper else with_arguments(scene)
        text = former = scene.read_text()
        for now, then in FORMER_KEYS.items():
            former = former.replace(now, then)
        before = Run(scene, former, folder / "old", [old], without_new_keys(arguments)).digest()
        after = Run(scene, text, folder / "new", [new], arguments).digest()
        different += before != after
        print(f"| `{scene.stem}` | {before} | {after} | {'same' if before == after else 'DIFFERENT'} |", flush=True)
    return 1 if different else 0


def main() -> int:
    arguments, command = sys.argv[1:], []
    if "--" in arguments:
        at = arguments.index("--")
        arguments, command = arguments[:at], arguments[at + 1:]
    if len(arguments) in (4, 6) and arguments[1] == "--table":
        old, new = (str(Path(program).resolve()) for program in arguments[2:4])
        return table(Path(arguments[0]), old, new, arguments[5] if arguments[4:5] == ["-k"] else "")
    if not command or len(arguments) not in (1, 3) or arguments[1:2] not in ([], ["-k"]):
        sys.exit(__doc__)
    return check(Path(arguments[0]), arguments[2] if len(arguments) == 3 else "", command)


if __name__ == "__main__":
    sys.exit(main())
