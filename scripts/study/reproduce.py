#!/usr/bin/python3
"""Makes the packs of the paper's four tables and writes how they compare: doc/reproduction.md, its data and its plot.

usage: scripts/study/reproduce.py [--seeds N] [--examples 5.1 5.3 ...] [--jobs N] [--dry-run | --report-only]

Runs build/packmpi on input/paper_5_*.toml, rotation on and off, seeds 1 .. N, one rank a run, as many runs at a time as
there are cores. Runs that are done are kept in results/reproduction and not repeated while the scene and the program's
sources are the same: stop it at any time and start it again. The full set takes about an hour of one core.
"""
import argparse
import csv
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import readings_report
import reproduction_report as report
from common import ENVIRONMENT, ROOT, fail

EXAMPLES = ("5.1", "5.2", "5.3", "5.4")
USUAL_SECONDS = {"5.1": 3.0, "5.2": 3.0, "5.3": 30.0, "5.4": 35.0}  # for the first estimates of the time left only


def output_of(*command):
    """Standard output of a command, or None if it fails."""
    done = subprocess.run(command, cwd=ROOT, env=ENVIRONMENT, capture_output=True, text=True)
    return done.stdout if done.returncode == 0 else None


class Run:
    """One pack: an example, rotation on or off, a seed."""

    def __init__(self, options, example, rotation, seed):
        self.example, self.rotation, self.seed = example, rotation, seed
        self.name = "paper_" + example.replace(".", "_")
        self.folder = options.results / f"{self.name}_{rotation}" / f"seed_{seed:02d}"
        self.summary = self.folder / f"{self.name}.json"
        sets = [f"dynamics.rotation={'true' if rotation == 'on' else 'false'}", *options.set]
        self.arguments = [f"input/{self.name}.toml", "--seed", str(seed)]
        for one in sets:
            self.arguments += ["--set", one]

    def command(self, program):
        return ["mpirun", "-n", "1", str(program), *self.arguments, "-o", str(self.folder), "--force", "--quiet"]

    def result(self):
        """The summary of a run that is done, else None."""
        try:
            return json.loads(self.summary.read_text())
        except (OSError, ValueError):
            return None

    def title(self):
        return f"example {self.example}, rotation {self.rotation}, seed {self.seed}"


class Sameness:
    """Whether a run made earlier is what the program would make now."""

    def __init__(self, program):
        self.program = program
        words = output_of(str(program), "--version")
        if words is None:
            fail(f"{program} does not run; build it with scripts/build.sh")
        self.git = words.split("(")[1].split(",")[0].strip()
        self.sources = {}
        self.scenes = {}

    def same(self, run):
        summary = run.result()
        if summary is None:
            return False
        made = summary["provenance"]
        return self.source_of(made["git"]) == self.source_of(self.git) and \
            self.without_name(made["effective_input"]) == self.scene_of(run)

    def source_of(self, git):
        """The tree of src/ at that commit: commits that leave the sources alone change nothing."""
        if git not in self.sources:
            tree = None if "dirty" in git else output_of("git", "rev-parse", f"{git}:src")
            self.sources[git] = tree or git
        return self.sources[git]

    def scene_of(self, run):
        key = tuple(run.arguments)
        if key not in self.scenes:
            words = output_of(str(self.program), "check", *run.arguments)
            if words is None:
                fail(f"the scene is refused: {self.program} check {' '.join(run.arguments)}")
            self.scenes[key] = self.without_name(words)
        return self.scenes[key]

    @staticmethod
    def without_name(text):
        """The scene's lines, without comments, which hold what is derived."""
        lines = [line.split(" #")[0].strip() for line in text.splitlines()]
        return [line for line in lines if line and not line.startswith("#")]


class Progress:
    """What is done, and how long the rest will take at the pace so far."""

    def __init__(self, runs, jobs):
        self.total, self.jobs, self.start = len(runs), jobs, time.monotonic()
        self.work_left = sum(USUAL_SECONDS[run.example] for run in runs)
        self.work_done, self.count = 0.0, 0

    def tell(self, run):
        self.count += 1
        self.work_done += USUAL_SECONDS[run.example]
        self.work_left -= USUAL_SECONDS[run.example]
        elapsed = time.monotonic() - self.start
        left = elapsed * self.work_left / self.work_done
        got = run.result()["achieved"]
        print(f"[{self.count}/{self.total}] {run.title()}: phi {got['phi']:.4f}, phi_bulk {got['phi_bulk']:.4f};  "
              f"{elapsed / 60.0:.1f} min gone, about {left / 60.0:.1f} min left", flush=True)


def make(runs, program, jobs):
    """`jobs` runs at a time. A run that fails stops everything, with its output."""
    progress = Progress(runs, jobs)
    waiting, active = list(runs), {}
    try:
        while waiting or active:
            while waiting and len(active) < jobs:
                run = waiting.pop(0)
                run.folder.mkdir(parents=True, exist_ok=True)
                run.summary.unlink(missing_ok=True)  # an old one must not pass for this one's
                log = open(run.folder / "output.txt", "w")
                active[run] = subprocess.Popen(run.command(program), cwd=ROOT, env=ENVIRONMENT, stdout=log,
                                               stderr=log)
                log.close()
            for run, process in list(active.items()):
                if process.poll() is None:
                    continue
                del active[run]
                if process.returncode not in (0, 3) or run.result() is None:
                    fail(f"{run.title()} ended with exit code {process.returncode}:\n"
                         + (run.folder / "output.txt").read_text())
                progress.tell(run)
            time.sleep(0.05)
    finally:
        for process in active.values():
            process.terminate()


def row_of(run, summary):
    """One line of reproduction.csv."""
    got, audit, made = summary["achieved"], summary["audit"], summary["provenance"]
    row = {"example": run.example, "rotation": run.rotation, "seed": run.seed, "layers": len(summary["layers"])}
    for key in ("particles", "phi", "phi_bulk", "height", "top", "compaction_rate", "coordination", "rattlers", "mean_overlap",
                "kinetic_energy", "floor_force", "weight", "time_step", "steps", "particle_steps", "reached"):
        row[key] = got[key]
    for key in ("lost", "non_finite", "outside", "worst_overlap", "worst_wall_penetration"):
        row[key] = audit[key]
    for key in ("wall_seconds", "version", "git"):
        row[key] = made[key]
    return row


def parse():
    parser = argparse.ArgumentParser(description="Make the packs of the paper's tables and compare.")
    parser.add_argument("--seeds", type=int, default=10, help="seeds 1 .. N of each cell (default 10)")
    parser.add_argument("--examples", nargs="+", choices=EXAMPLES, default=EXAMPLES, help="default: all four")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="runs at a time (default: one a core)")
    parser.add_argument("--program", type=Path, default=ROOT / "build" / "packmpi")
    parser.add_argument("--results", type=Path, default=ROOT / "results" / "reproduction",
                        help="where the runs are kept")
    parser.add_argument("--doc", type=Path, default=ROOT / "doc", help="where the report goes")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="change the scenes (tests)")
    parser.add_argument("--dry-run", action="store_true", help="print the commands that would run, do nothing")
    parser.add_argument("--report-only", action="store_true", help="report on the runs there are")
    options = parser.parse_args()
    if options.seeds < 1 or options.jobs < 1:
        fail("--seeds and --jobs must be at least 1")
    options.program, options.results = options.program.resolve(), options.results.resolve()
    return options


def write_csv(path, rows):
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def main():
    options = parse()
    runs = [Run(options, example, rotation, seed)
            for example in options.examples for rotation in ("on", "off") for seed in range(1, options.seeds + 1)]
    if not options.report_only:
        sameness = Sameness(options.program)
        to_do = [run for run in runs if not sameness.same(run)]
        to_do.sort(key=lambda run: -USUAL_SECONDS[run.example])  # long ones first: all cores end together
        print(f"{len(runs)} runs, {len(runs) - len(to_do)} of them done already; {options.jobs} at a time", flush=True)
        if options.dry_run:
            for run in to_do:
                print(" ".join(run.command(options.program)))
            return 0
        make(to_do, options.program, options.jobs)
    done = [(run, run.result()) for run in runs]
    rows = [row_of(run, summary) for run, summary in done if summary is not None]
    if not rows:
        fail(f"there are no runs in {options.results}")
    write_csv(options.doc / "data" / "reproduction.csv", rows)
    passed = report.write(options.doc, ROOT / "doc" / "data", rows, readings_report.chapter(ROOT / "doc" / "data"))
    print(f"{options.doc / 'reproduction.md'} written; all criteria met: {'yes' if passed else 'NO'}")
    return 0 if passed else 3


if __name__ == "__main__":
    sys.exit(main())
