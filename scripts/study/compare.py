#!/usr/bin/python3
"""packmpi, LAMMPS and LIGGGHTS on the same scenes, in turn, in the same minutes, on the same core.

  scripts/study/compare.sh [--runs 3] [--seeds 2] [--beds 107000 964000 | --no-beds] [--no-brick] [--memory] [--quick] [--core 0]

Beds: settled beds of the paper's spheres between walls (rotation on, time step 1e-4 s), written by
tests/bench/bed_bench.cpp; all codes advance the same particles, equal ones and, packmpi and LAMMPS, Gaussian ones (sd 0.1
of the mean); particle-steps a second, everything in. Brick: example 5.3 from nothing to the twelfth layer: wall time, and
the pack that came out by one analysis for all codes; packmpi with the paper's protocol and with a fast one. --memory: the
brick alone, by friction with memory, packmpi by its presets and LAMMPS. --quick: small scenes, to try the script. The
tables replace the blocks of the document between "compare ..." markers. 22 to 60 minutes.
"""
import argparse
import math
import re
import statistics
import subprocess
import sys
import tempfile
import time
from functools import partial
from pathlib import Path

import numpy as np

import measuring

PEERS = measuring.ROOT / "scripts/study/peers"
PAPER, FAST = "packmpi, `\"paper\"`", "packmpi, `\"balanced\"`"   # by fidelity
RADIUS, HEIGHT = 0.02, 0.5   # [m] of example 5.3
LARGE = 500000   # spheres of a bed, whose block is another


class Machine:
    """Runs commands on one core, in a folder of its own."""

    def __init__(self, core, folder):
        self.core, self.folder = core, Path(folder)

    def run(self, *words):
        """What the command said, and its wall time [s]."""
        start = time.monotonic()
        done = subprocess.run(["taskset", "-c", str(self.core), *map(str, words)], cwd=self.folder,
                              env=measuring.ENVIRONMENT, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              stdin=subprocess.DEVNULL, check=False)
        if done.returncode not in (0, 3):   # 3: a pack below the asked height, which twelve layers may be
            sys.exit(f"{' '.join(map(str, words))}\n{done.stdout[-3000:]}\nended with {done.returncode}")
        return done.stdout, time.monotonic() - start


def peer_rate(text, atoms):
    """Median particle-steps a second of the 'Loop time' lines, but the first, which is the warm-up."""
    loops = re.findall(r"Loop time of (\S+) on \d+ procs for (\d+) steps with (\d+) atoms", text)
    if len(loops) < 2 or any(int(n) != atoms for _, _, n in loops):
        sys.exit(f"a peer lost particles or said nothing:\n{text[-2000:]}")
    return statistics.median(int(steps) * atoms / float(seconds) for seconds, steps, _ in loops[1:])


def one_bed(machine, options, particles, deviation):
    """Particle-steps a second of each code on one bed, and what the bed is."""
    steps = 300 if particles < 500000 else 60
    data = machine.folder / "bed.data"
    text, _ = machine.run(options.build / "tests/bench/bed_bench", particles, steps, 3, 1, deviation, data)
    atoms = int(re.search(r"(\d+) particles on", text)[1])
    head = data.read_text()[:400]
    side = float(re.search(r"-0.005 (\S+) xlo xhi", head)[1]) - 0.005
    rates = {"packmpi": float(re.search(r"median (\S+)e6", text)[1]) * 1e6}
    common = ["-var", "data", data, "-var", "S", f"{side:.6f}", "-var", "n", steps, "-var", "warm", steps]
    text, _ = machine.run("lmp", "-in", PEERS / "lammps/bed.in", *common, "-log", "none")
    rates["LAMMPS"] = peer_rate(text, atoms)
    if deviation == 0:
        text, _ = machine.run("liggghts", "-in", PEERS / "liggghts/bed.in", *common, "-log", "liggghts.log")
        rates["LIGGGHTS"] = peer_rate(text, atoms)
    return atoms, rates


def beds(machine, options):
    """Particles wanted, and a row: what, and for each run the rates by code."""
    rows = []
    for particles in options.beds:
        runs = {0: [], 0.1: []}
        atoms = {}
        for run in range(options.runs):
            for deviation, found in runs.items():
                atoms[deviation], rates = one_bed(machine, options, particles, deviation)
                found.append(rates)
                print(f"bed of {atoms[deviation]}, sd {deviation}, run {run + 1}: "
                      + ", ".join(f"{code} {rate * 1e-6:.1f}e6" for code, rate in rates.items()), flush=True)
        rows += [(particles, (f"{atoms[sd]:,}, {'Gaussian' if sd else 'equal'}", found)) for sd, found in runs.items()]
    return rows


def packmpi_brick(machine, options, seed, settings):
    folder = machine.folder / "pack"
    settings = {"layers.maximum": options.layers, "container.size": f"[{options.side},{options.side},{HEIGHT}]", **settings}
    sliding = ("regularisation", "friction_velocity") if options.memory else ()   # keys of the other law
    _, seconds = machine.run(options.build / "packmpi", measuring.bare_scene("paper_5_3", machine.folder, sliding), "-q", "--force", "--seed", seed,
                             "-o", folder, *measuring.options_of(settings))
    return seconds, *measuring.read_pack(folder / "paper_5_3.hdf")


def peer_brick(machine, options, code, seed):
    program, folder = {"LAMMPS": ("lmp", "lammps"), "LIGGGHTS": ("liggghts", "liggghts")}[code]
    variables = {"tag": code, "seed": seed, "layers": options.layers, "steps": round(options.duration / 1e-4),
                 "side": options.side}
    if code == "LAMMPS":
        variables |= {"mol": PEERS / "lammps/sphere.mol", "memory": int(options.memory)}
    words = [word for key, value in variables.items() for word in ("-var", key, value)]
    _, seconds = machine.run(program, "-in", PEERS / folder / "brick.in", *words, "-log", f"{folder}.log")
    positions = measuring.read_dump(machine.folder / f"brick_{code}.dump")
    return seconds, positions, np.full(len(positions), RADIUS)


def brick_makers(machine, options):
    """Of each code and protocol what makes the pack of a seed."""
    if options.memory:
        ours = {f'packmpi, `"{name}"`': {"fidelity": name, "contact.tangential": "mindlin"} for name in ("balanced", "draft")}
    else:
        ours = {PAPER: {"fidelity": "paper", "layers.duration": options.duration}, FAST: {"fidelity": "balanced", **measuring.SLIDING}}
    makers = {name: partial(packmpi_brick, machine, options, settings=settings) for name, settings in ours.items()}
    return makers | {code: partial(peer_brick, machine, options, code) for code in peers_of(options)}


def peers_of(options):
    return ["LAMMPS"] if options.memory else ["LAMMPS", "LIGGGHTS"]


def bricks(machine, options):
    """For each code and protocol the runs' seconds and measures."""
    makers = brick_makers(machine, options)
    found = {name: [] for name in makers}
    for seed in range(1, options.seeds + 1):
        for name, make in makers.items():
            seconds, positions, radii = make(seed=seed)
            found[name].append({"seconds": seconds, **measuring.analyse(positions, radii, options.side, HEIGHT)})
            print(f"brick, seed {seed}, {name}: {seconds:.1f} s, phi_bulk {found[name][-1]['phi_bulk']:.4f}", flush=True)
    return found


def ratios(runs, code):
    return [run["packmpi"] / run[code] for run in runs if code in run]


def bed_table(rows):
    out = ["| settled bed | packmpi, 1e6 particle-steps/s | LAMMPS | LIGGGHTS | / LAMMPS | / LIGGGHTS |", "|---|---|---|---|---|---|"]
    for what, runs in rows:
        cells = [measuring.spread([run[code] for run in runs], 1, 1e-6) if code in runs[0] else ""
                 for code in ("packmpi", "LAMMPS", "LIGGGHTS")]
        cells += [measuring.spread(ratios(runs, code), 2) if code in runs[0] else "" for code in ("LAMMPS", "LIGGGHTS")]
        out.append("| " + " | ".join([what, *cells]) + " |")
    return out


def brick_table(found):
    out = ["| example 5.3, whole job | s | LAMMPS' time over it | spheres | phi_bulk | coordination | mean overlap / r |",
           "|---|---|---|---|---|---|---|"]
    for name, runs in found.items():
        gains = [other["seconds"] / run["seconds"] for run, other in zip(runs, found["LAMMPS"])]
        mean = {key: statistics.mean(run[key] for run in runs) for key in ("spheres", "phi_bulk", "coordination", "overlap")}
        out.append(f"| {name} | {measuring.spread([run['seconds'] for run in runs])} | {measuring.spread(gains, 2)} | {mean['spheres']:.0f} | "
                   f"{mean['phi_bulk']:.4f} | {mean['coordination']:.2f} | {mean['overlap']:.2e} |")
    if PAPER not in found:
        return out
    paper, fast = found[PAPER], found[FAST]
    phi, contacts = ([f[key] - p[key] for f, p in zip(fast, paper)] for key in ("phi_bulk", "coordination"))
    overlap = statistics.mean(f["overlap"] / p["overlap"] for f, p in zip(fast, paper))
    return out + ["", f"`\"balanced\"` against `\"paper\"`, mean of {len(fast)} seeds and its standard error: phi_bulk {with_error(phi, 4)}, coordination "
                  f"{with_error(contacts, 3)}, mean overlap x {overlap:.2f}."]


def with_error(values, digits):
    error = statistics.stdev(values) / len(values) ** 0.5 if len(values) > 1 else math.nan
    return f"{statistics.mean(values):+.{digits}f} +- {error:.{digits}f}"


def version(words, pattern):
    with tempfile.TemporaryDirectory() as folder:   # LIGGGHTS leaves a log where it is asked
        said = subprocess.run(words, text=True, capture_output=True, stdin=subprocess.DEVNULL, cwd=folder, check=False).stdout
    got = re.search(pattern, said)
    return got[1] if got else "of unknown version"


def blocks(options, rows, found):
    """What was measured, by name of its block in the document, each with its own date and commit."""
    versions = {"LAMMPS": version(["lmp", "-h"], r"(\d+ \w{3} 20\d\d)"), "LIGGGHTS": version(["liggghts", "-h"], r"LIGGGHTS-PUBLIC ([\d.]+)")}
    peers = ", ".join(f"{code} {versions[code]}" for code in peers_of(options))
    flags = "".join(f" --{name}" for name in ("quick", "memory") if getattr(options, name))
    friction = "friction with memory (LAMMPS: mindlin_rescale/force)" if options.memory else "sliding friction without history"
    made = (f"{measuring.made_by('scripts/study/compare.sh' + flags)}, all on core {options.core} in turn. "
            f"{peers}, of Debian. Hertz contacts, the same damping, {friction}, rotation. ")
    spread = " of each. Median (least to most); ratios are taken run by run."
    tables = {"compare brick with memory" if options.memory else "compare brick": (f"{options.seeds} seeds", brick_table(found) if found else [])}
    for name, wanted in (("compare beds", False), ("compare large beds", True)):
        mine = [row for size, row in rows if (size >= LARGE) == wanted]
        tables[name] = (f"{options.runs} runs", bed_table(mine) if mine else [])
    return {name: "\n".join([made + what + spread, "", *table]) for name, (what, table) in tables.items() if table}


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=3, help="of each bed")
    parser.add_argument("--seeds", type=int, default=2, help="of the brick")
    parser.add_argument("--beds", type=int, nargs="+", default=[107000, 964000], help="spheres")
    parser.add_argument("--no-beds", dest="beds", action="store_const", const=[])
    parser.add_argument("--no-brick", dest="brick", action="store_false")
    parser.add_argument("--memory", action="store_true", help="the brick by friction with memory, no beds")
    parser.add_argument("--quick", action="store_true", help="a bed of 9000 and a small, short brick, once")
    parser.add_argument("--core", type=int, default=0)
    parser.add_argument("--build", type=Path, default=measuring.ROOT / "build")
    parser.add_argument("--doc", type=Path, default=measuring.ROOT / "doc/performance.md")
    options = parser.parse_args()
    options.build = options.build.resolve()
    options.side, options.layers, options.duration = 1.0, 12, 1.0
    options.beds = [] if options.memory else options.beds
    if options.quick:
        options.runs = options.seeds = 1
        options.beds = options.beds and [9000]
        options.side, options.layers, options.duration = 0.3, 3, 0.5
    return options


def main():
    options = parse()
    with tempfile.TemporaryDirectory() as folder:
        machine = Machine(options.core, folder)
        rows = beds(machine, options)
        found = bricks(machine, options) if options.brick else {}
    for name, text in blocks(options, rows, found).items():
        print(text)
        measuring.write_block(options.doc, name, text)


if __name__ == "__main__":
    main()
