#!/usr/bin/python3
"""Tries readings of where the paper's Algorithm 1 inserts a layer and when it stops, on all eight columns of its tables.

usage: scripts/study/readings.py [--seeds N] [--only NAME ...] [--examples 5.1 ...] [--jobs N] [--report-only]

Builds and runs build/tests/bench/readings on input/paper_5_*.toml. A run is one pack of one way to insert; it gives the
bed after each layer, from which all rules to stop and all volumes V of eq. (22) are read, so that they cost no run of
their own. Runs that are done are kept in results/readings; delete that folder after a change of the sources. The table
goes into doc/reproduction.md, between its markers, and every pack into doc/data/readings.csv. Packs that are in that table
are not made again unless --anew says so; --report-only makes the page's table of the packs there are.
In 2D a pack takes seconds, in 3D some minutes of one core.
"""
import argparse
import csv
import os
import subprocess
import sys
import time
from pathlib import Path

import readings_report as report
from common import ENVIRONMENT, ROOT, fail

EXAMPLES = ("5.1", "5.2", "5.3", "5.4")


class Run:
    """One pack: a way to insert, an example, rotation on or off, a seed."""

    def __init__(self, results, way, example, rotation, seed, ends=""):
        self.way, self.example, self.rotation, self.seed = way, example, rotation, seed
        self.ends = ends
        self.file = results / way.name / f"{example}_{rotation}_{seed:02d}.csv"

    @property
    def key(self):
        return self.way.name, self.example, self.rotation, self.seed

    def command(self, program):
        return ["mpirun", "-n", "1", str(program), f"input/paper_{self.example.replace('.', '_')}.toml", str(self.seed),
                *self.way.arguments, self.ends, f"dynamics.rotation={'true' if self.rotation == 'on' else 'false'}",
                "layers.attempts=2000"]

    def layers(self):
        """The bed after each layer: dictionaries of numbers; of a run that is not done, as far as it went."""
        with open(self.file if self.file.exists() else self.file.with_suffix(".part"), newline="") as file:
            return [{key: value if key == "end" else float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def make(runs, program, jobs):
    """`jobs` runs at a time, those of few particles first."""
    start, active, done = time.monotonic(), {}, 0
    waiting = list(runs)
    while waiting or active:
        while waiting and len(active) < jobs:
            run = waiting.pop(0)
            run.file.parent.mkdir(parents=True, exist_ok=True)
            with open(run.file.with_suffix(".part"), "w") as out:
                active[run] = subprocess.Popen(run.command(program), cwd=ROOT, env=ENVIRONMENT, stdout=out)
        for run, process in list(active.items()):
            if process.poll() is None:
                continue
            del active[run]
            if process.returncode != 0:
                fail(f"{' '.join(run.command(program))} ended with exit code {process.returncode}")
            run.file.with_suffix(".part").rename(run.file)
            done += 1
            print(f"[{done}/{len(runs)}] {run.way.name} {run.example} {run.rotation} seed {run.seed}: "
                  f"{run.layers()[-1]['particles']:.0f} particles, {(time.monotonic() - start) / 60.0:.1f} min", flush=True)
        time.sleep(0.05)


def tabled(doc):
    """Runs whose packs are in doc/data/readings.csv, with their ends."""
    file = doc / "data" / "readings.csv"
    rows = report.tables.read(file) if file.exists() else []
    return {(row["way"], row["example"], row["rotation"], int(row["seed"])) for row in rows if row["stop"] != report.UNFINISHED}


def parse():
    parser = argparse.ArgumentParser(description="Try readings of the paper's algorithm on its tables.")
    parser.add_argument("--seeds", type=int, default=2, help="seeds 1 .. N of each column (default 2)")
    parser.add_argument("--only", nargs="+", choices=[way.name for way in report.WAYS], help="ways to insert (default: all)")
    parser.add_argument("--ends", nargs="+", choices=report.ENDS, default=report.ENDS, help="default: all")
    parser.add_argument("--examples", nargs="+", choices=EXAMPLES, default=EXAMPLES, help="default: all four")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="runs at a time (default: one a core)")
    parser.add_argument("--build", type=Path, default=ROOT / "build")
    parser.add_argument("--program", type=Path, help="an executable that is built already")
    parser.add_argument("--results", type=Path, default=ROOT / "results" / "readings")
    parser.add_argument("--doc", type=Path, default=ROOT / "doc", help="where the table goes")
    parser.add_argument("--anew", action="store_true", help="make packs that are in the table once more")
    parser.add_argument("--report-only", action="store_true", help="report on the runs there are")
    options = parser.parse_args()
    options.build, options.results = options.build.resolve(), options.results.resolve()
    return options


def main():
    options = parse()
    if not options.report_only:
        if options.program is None:
            subprocess.run(["cmake", "--build", str(options.build), "--target", "readings", "--", "--quiet"], check=True)
            options.program = options.build / "tests" / "bench" / "readings"
        runs = [Run(options.results, way, example, rotation, seed, ",".join(options.ends))
                for seed in range(1, options.seeds + 1) for way in report.WAYS if way.name in (options.only or way.name)
                for example in options.examples for rotation in ("on", "off")]
        there = set() if options.anew else tabled(options.doc)
        make([run for run in runs if not run.file.exists() and run.key not in there], options.program, options.jobs)
    kept = [Run(options.results, way, *file.stem.split("_")[:2], int(file.stem.split("_")[2]))
            for way in report.WAYS for file in sorted((options.results / way.name).glob("*.*"))]
    report.write(options.doc, [(run, run.layers()) for run in kept if run.layers()])
    return 0


if __name__ == "__main__":
    sys.exit(main())
