#!/usr/bin/python3
"""Two builds against each other, in turn on one core: rows of Markdown, with spread.

usage: scripts/study/bench.py --builds build-before build [--bench step_bench bed_bench ...] [--job input/quickstart.toml ...]
                              [-n 7] [--core 0] [--set KEY=VALUE ...] [--set-second KEY=VALUE ...] [--doc FILE --block NAME]

A benchmark is a program of tests/bench (BUILD/tests/bench/NAME, made by scripts/build.sh all), "NAME:ARGUMENTS" with others than
those of BENCHES; a job is a whole run of BUILD/packmpi, in CPU seconds. A pair is both builds one after the other, the first of
them by turns, so that what else the machine does falls on both. Ratios are taken pair by pair: the second build's speed over the
first's. For jobs the digests of the packs are compared, too. Exit code 1 if they differ.
"""
import argparse
import re
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import measuring

NUMBER = r"([\d.]+(?:e[+-]?\d+)?)"
# Arguments, and what is read of the output: a pattern of (name and) number, whether more is better, and its unit.
BENCHES = {
    "step_bench": ("30000 3", rf"^(.+?) +N +\d+ .*? {NUMBER}e6/s", True, "1e6 particle-steps/s"),
    "bed_bench": ("107000 100 3", rf"^()particle-steps/s a core: median {NUMBER}e6", True, "1e6 particle-steps/s"),
    "rsa_bench": ("6e4 0.25 3", rf"^()best {NUMBER} s on", False, "s"),
    "checkpoint_bench": ("300000 . 3", rf"^(write|read and verify): {NUMBER} s", False, "s"),
}


class Build:
    """A build folder and what its program says of itself."""

    def __init__(self, folder, second):
        self.folder, self.second = Path(folder).resolve(), second
        said = subprocess.run([self.folder / "packmpi", "--version"], env=measuring.ENVIRONMENT, text=True, capture_output=True, check=True).stdout
        self.commit = re.search(r"\(([^,]+),", said)[1]


class Measure:
    """Numbers of one kind: a list for each of the two builds, and how to read them."""

    def __init__(self, name, unit, more_is_better):
        self.name, self.unit, self.more_is_better = name, unit, more_is_better
        self.values = ([], [])

    def ratios(self):
        """Speed of the second build over that of the first, pair by pair."""
        first, second = self.values if self.more_is_better else self.values[::-1]
        return [b / a for a, b in zip(first, second)]

    def row(self):
        cells = [measuring.spread(values, 3 if max(values) < 10.0 else 1) for values in self.values]
        return f"| {self.name}, {self.unit} | {cells[0]} | {cells[1]} | {measuring.spread(self.ratios(), 3)} |"


def run(core, *words, codes=(0,)):
    """What a command said on one core, and its CPU seconds."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(["taskset", "-c", str(core), *map(str, words)], env=measuring.ENVIRONMENT, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in codes:
        sys.exit(f"bench: {' '.join(map(str, words))} ended with {done.returncode}\n{done.stdout[-2000:]}")
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def bench(options, word):
    """A function of a build that gives {name: number}, with unit and direction."""
    name, _, arguments = word.partition(":")
    if name not in BENCHES:
        sys.exit(f"bench: {name} is none of {', '.join(BENCHES)}")
    standard, pattern, more, unit = BENCHES[name]

    def measure(build):
        text, _ = run(options.core, build.folder / "tests/bench" / name, *(arguments or standard).split())
        found = dict(re.findall(pattern, text, re.MULTILINE))
        if not found:
            sys.exit(f"bench: {name} of {build.folder} said nothing that was understood:\n{text[-500:]}")
        return {f"{name}{': ' if what else ''}{what}": float(number) for what, number in found.items()}
    return measure, unit, more


def job(options, scene, digests):
    """The same for a whole run; the digest of its pack goes into `digests`."""
    def measure(build):
        with tempfile.TemporaryDirectory() as folder:
            changes = options.set + (options.set_second if build.second else [])
            _, seconds = run(options.core, build.folder / "packmpi", scene, "-q", "-o", folder, *(word for one in changes for word in ("--set", one)),
                             codes=(0, 3))
            told, _ = run(options.core, build.folder / "packmpi", "info", Path(folder) / f"{Path(scene).stem}.hdf")
        digests.setdefault(scene, set()).add(re.search(r"digest of the particles (\w+)", told)[1])
        return {f"{Path(scene).name}, whole job": seconds}
    return measure, "CPU s", False


def compare(builds, pairs, measure, unit, more):
    """The measures of both builds in turn."""
    found = {}
    for k in range(pairs):
        for which in ((0, 1) if k % 2 == 0 else (1, 0)):
            for name, value in measure(builds[which]).items():
                found.setdefault(name, Measure(name, unit, more)).values[which].append(value)
    return list(found.values())


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--builds", nargs=2, required=True, metavar=("BEFORE", "AFTER"), help="build folders")
    parser.add_argument("--bench", nargs="+", default=[], help='of tests/bench, "NAME" or "NAME:ARGUMENTS"')
    parser.add_argument("--job", nargs="+", default=[], help="scenes to be run as a whole")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="changes the scenes of jobs")
    parser.add_argument("--set-second", action="append", default=[], metavar="KEY=VALUE", help="the same for the second build alone, of keys that "
                        "the first does not know")
    parser.add_argument("-n", "--pairs", type=int, default=7)
    parser.add_argument("--core", type=int, default=0)
    parser.add_argument("--doc", type=Path, help="document whose block is written anew")
    parser.add_argument("--block", default="bench", help="name of that block's markers")
    options = parser.parse_args()
    if not options.bench and not options.job:
        options.bench = ["step_bench"]
    return options


def main():
    options = parse()
    builds = [Build(folder, second) for folder, second in zip(options.builds, (False, True))]
    digests, measures = {}, []
    for ready in [bench(options, word) for word in options.bench] + [job(options, scene, digests) for scene in options.job]:
        measures += compare(builds, options.pairs, *ready)
    same = {scene: "the same bits" if len(found) == 1 else "OTHER BITS" for scene, found in digests.items()}
    lines = [f"{measuring.made_by('scripts/study/bench.py')}, core {options.core}, {options.pairs} pairs in turn; median (least to most)."
             + "".join(f" {Path(scene).name}: {words}." for scene, words in same.items()), "",
             f"| | {builds[0].commit} | {builds[1].commit} | speed, second over first |", "|---|---|---|---|", *(measure.row() for measure in measures)]
    print("\n".join(lines))
    if options.doc:
        measuring.write_block(options.doc, options.block, "\n".join(lines))
    return 1 if "OTHER BITS" in same.values() else 0


if __name__ == "__main__":
    sys.exit(main())
