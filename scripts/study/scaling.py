#!/usr/bin/python3
"""What a run costs on many ranks: counts what 1 to 64 ranks do and send on blocks that grow with them, fits the cost of what was
counted on 1 and 2 ranks, and writes both and a prediction for clusters into doc/scaling.md.

usage: scripts/study/scaling.py [--quick] [--ranks 64] [--only counts timing] [--latency s] [--node-bandwidth B/s] ...

Counts are exact and do not depend on how busy the machine is: more ranks than cores are no matter. Costs are CPU seconds.
Results are kept in results/scaling and not made anew while the program and the settings are the same. The exit code is 1 if a
check of the counts fails. --quick: 1 to 8 ranks, counts only, nothing kept or written; ctest runs it.
"""
import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

try:
    import measuring
except ModuleNotFoundError as missing:   # numpy
    print(f"scaling: {missing}")
    sys.exit(77)   # a test that is skipped

RADIUS, MARGIN = 0.01, 0.2               # m; the largest margin of a particle in lists, in radii (src/scene/scene.cpp)
RANGE = 2.0 * (1.0 + MARGIN) * RADIUS    # m: a ghost is nearer than this to another rank's column
COLUMNS = 12                             # of a rank's block, along each axis that is cut
TOLERANCE = 0.01                         # of the ghost formula
GROWTH = 1.05                            # of messages and bytes a rank, from the least ranks with all neighbours to the most
RANGE_53 = 2.0 * (1.0 + MARGIN) * 0.02   # m, of input/million.toml
LIVE_BYTES = 72                          # of a ghost a step: position, velocity, spin
MESSAGES = 2                             # to each neighbour rank a step: one for each half of the ghosts
RECORD_BYTES = 104                       # of a particle that changes owners: its record and its id
PURPOSES = ("ghost", "halo", "migration", "insertion", "output")

BLOCK = """schema_version = 1
seed = {seed}
[container]
dimension = 3
size = [{x:.17g}, {y:.17g}, {height:g}]
boundary = ["periodic", "periodic"]
[particles]
density = 1000.0
youngs_modulus = 1.0e6
poisson_ratio = 0.25
radius = {{ distribution = "equal", value = {radius:g} }}
[layers]
thickness = {height:g}
fraction = 0.1
velocity = [0.3, 0.2, -0.5]
duration = {duration:g}
maximum = 1
[jamming]
gravity = 2.0
[contact]
damping_ratio = 0.1
friction = 0.2
[dynamics]
time_step = 1.0e-4
[parallel]
decomposition = "{kind}"
[output]
log_every = {duration:g}
[rest]
wait = 0.0
"""

# Name, lateral extents [m], boundary, ranks, other settings: input/million.toml with another floor. The first are fitted, the last held out.
SOFT = {"layers.duration": "0.1", "dynamics.relaxation": "0.1"}
FITTED = [("1m", 1.0, "wall", 1, {}), ("2m", 2.0, "wall", 1, {}), ("loose", 2.0, "wall", 1, SOFT),
          ("hard", 1.0, "wall", 1, {"dynamics.window": "0", "layers.maximum": "6", "dynamics.relaxation": "1.8"}),
          ("thin", 0.6, "periodic", 2, {"dynamics.relaxation": "2.7"}), ("two", 1.0, "periodic", 2, {}), ("loose two", 1.0, "periodic", 2, SOFT),
          ("two wide", 1.8, "periodic", 2, {})]
HELD_OUT = [("two apart", 0.8, "periodic", 2, {}), ("two walls", 1.4, "wall", 2, {}), ("six layers", 1.6, "wall", 1, {"layers.maximum": "6"}),
            ("wide", 2.6, "wall", 1, {})]
FITTED_TITLE = "### Fitted"
FEATURES = ("particle-step", "listed pair and step", "ghost and step", "slot and rebuild", "particle, once", "rank, once", "rank and step, of two")


class Run:
    """The counters of a run, by name."""

    def __init__(self, summary):
        self.ranks = summary["provenance"]["ranks"]
        self.steps = summary["achieved"]["steps"]
        self.particles = summary["achieved"]["particles"]
        self.git = summary["provenance"]["git"]
        self.wall = summary["provenance"]["wall_seconds"]
        self.numbers = {**summary["counters"], **summary["costs"]}

    def sum(self, name):
        return self.numbers[name]["sum"]

    def of_rank(self, name):
        return self.numbers[name]["of_rank"]

    def work(self):
        """CPU seconds of all ranks but those spent waiting in the reduction of a step."""
        return (self.sum("cpu") - self.sum("waiting")) * 1e-9

    def core(self):
        """Share of a core that each rank got: far below 1, and others ran on the machine, too."""
        return self.sum("cpu") * 1e-9 / self.ranks / self.wall

    def each(self, name):
        return self.sum(name) / self.ranks


def start(options, name, scene, ranks, settings, repeat=0, limit=None):
    """Runs the program, or takes what it found before with the same program and settings. None after `limit` seconds."""
    kept = options.results / f"{name}.json"
    key = [options.version, Path(scene).read_text(), settings, ranks, repeat]
    if not options.quick and kept.exists() and (found := json.loads(kept.read_text()))["key"] == key:
        return Run(found["summary"])
    folder = options.results / "run"
    try:
        done = subprocess.run([options.mpirun, "-n", str(ranks), options.program, scene, "-q", "--force", "-o", folder,
                               *measuring.options_of(settings)], env=measuring.ENVIRONMENT, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, check=False, timeout=limit)
    except subprocess.TimeoutExpired:
        return None
    if done.returncode not in (0, 3):
        sys.exit(f"scaling: {name} ended with exit code {done.returncode}\n{done.stdout[-2000:]}")
    summary = json.loads((folder / f"{Path(scene).stem}.json").read_text())
    if not options.quick:
        kept.write_text(json.dumps({"key": key, "summary": summary}))
        print(f"{name}: {summary['achieved']['particles']} particles, {summary['provenance']['wall_seconds']:.1f} s", flush=True)
    return Run(summary)


def factors(ranks):
    """Px >= Py of a square number of parts, or of two squares."""
    py = 1 << (int(math.log2(ranks)) // 2)
    return ranks // py, py


def block(options, kind, ranks, seed):
    """A run of a block of COLUMNS columns a rank and cut axis; the rank's own block is the same for any number of ranks."""
    px, py = factors(ranks) if kind == "pencil" else (ranks, 1)
    edge = COLUMNS * RANGE * (1.0 + 1e-9)
    steps = 20 if options.quick else 60
    scene = options.results / "block.toml"
    scene.write_text(BLOCK.format(seed=seed, x=px * edge, y=py * edge, height=options.height, radius=RADIUS, duration=steps * 1e-4, kind=kind))
    return start(options, f"{kind}_{ranks}_{seed}", scene, ranks, {})


def formula(kind, ranks, corner):
    """Ghosts a particle of a homogeneous block: the border strip of width RANGE around a rank's block, corners times RANGE^2."""
    px, py = factors(ranks) if kind == "pencil" else (ranks, 1)
    share = RANGE / (COLUMNS * RANGE)
    return 2.0 * share * ((px > 1) + (py > 1)) + corner * share * share * (px > 1 and py > 1)


def pooled(runs):
    """Ghosts a particle over all ranks of all runs, and the standard error of it by their spread."""
    shares = [g / p for run in runs for g, p in zip(run.of_rank("ghost_steps"), run.of_rank("particle_steps"))]
    mean = sum(run.sum("ghost_steps") for run in runs) / sum(run.sum("particle_steps") for run in runs)
    spread = math.sqrt(sum((s - mean) ** 2 for s in shares) / max(1, len(shares) - 1))
    return mean, spread / math.sqrt(len(shares))


def count(options):
    """Runs by (kind, ranks)."""
    runs = {}
    for kind in ("slab", "pencil"):
        ranks = 1
        while ranks <= options.ranks:
            if kind == "pencil" and ranks <= 2:   # a slab
                ranks *= 2
                continue
            seeds = 1 if ranks == 1 else max(1, options.samples // ranks)
            runs[kind, ranks] = [block(options, kind, ranks, seed) for seed in range(1, seeds + 1)]
            ranks *= 2
    return runs


def check_ghosts(options, runs, complaints):
    """Each row of the table by itself; --quick, whose rows are of few ranks, all rows of a formula together."""
    groups = {}
    for (kind, ranks), found in runs.items():
        groups.setdefault((formula(kind, ranks, math.pi), None if options.quick else (kind, ranks)), []).extend(found)
    for (right, _), found in groups.items():
        mean = pooled(found)[0]
        if abs(mean - right) > TOLERANCE * right:
            complaints.append(f"{mean:.4f} ghosts a particle on {', '.join(str(run.ranks) for run in found)} ranks, by the formula {right:.4f}")


def ghost_table(runs):
    out = ["| ranks | cut | runs | particles a rank | ghosts a particle | formula | difference | standard error | with 4 w^2 |", "|---|---|---|---|---|---|---|---|---|"]
    for (kind, ranks), found in runs.items():
        if ranks == 1:
            continue
        mean, error = pooled(found)
        right, square = formula(kind, ranks, math.pi), formula(kind, ranks, 4.0)
        off = mean / right - 1.0
        out.append(f"| {ranks} | {kind} | {len(found)} | {found[0].particles / ranks:.0f} | {mean:.4f} | {right:.4f} | {100 * off:+.2f} % | "
                   f"{100 * error / right:.2f} % | {100 * (mean / square - 1.0):+.2f} % |")
    return out


def neighbours(kind, ranks):
    px, py = factors(ranks) if kind == "pencil" else (ranks, 1)
    return min(px, 3) * min(py, 3) - 1


def traffic_table(runs):
    out = ["| ranks | cut | neighbours | steps, rebuilds | reductions | exchanges | " + " | ".join(f"{p}: messages, kB" for p in PURPOSES) + " |",
           "|---" * (6 + len(PURPOSES)) + "|"]
    for (kind, ranks), found in runs.items():
        run = found[0]
        cells = [f"{run.each(f'{p}_messages'):.1f}, {run.each(f'{p}_bytes') * 1e-3:.1f}" for p in PURPOSES]
        out.append(f"| {ranks} | {kind} | {neighbours(kind, ranks)} | {run.steps}, {run.each('rebuilds'):.0f} | {run.each('reductions'):.0f} | "
                   f"{run.each('exchanges'):.0f} | " + " | ".join(cells) + " |")
    return out


def rounds(run, purpose):
    """How often a run had reason to send for a purpose."""
    return {"ghost": run.steps, "halo": run.each("rebuilds"), "migration": run.each("rebuilds")}.get(purpose, 1)


def check_traffic(runs, complaints):
    """The step's messages and bytes a rank are the same from the first rank count on that has all neighbours a rank can have."""
    growth = {}
    for kind in ("slab", "pencil"):
        full = [ranks for k, ranks in runs if k == kind and neighbours(kind, ranks) == (8 if kind == "pencil" else 2)]
        if len(full) < 2:
            continue
        least, most = runs[kind, full[0]], runs[kind, full[-1]]
        for purpose in PURPOSES:
            for what in ("messages", "bytes"):
                name = f"{purpose}_{what}"
                before, after = (sum(run.each(name) / rounds(run, purpose) for run in group) / len(group) for group in (least, most))
                growth[kind, name] = (full[0], full[-1], after / before if before > 0 else 1.0)
                noise = 0.0   # particles that happen to change owners: three standard deviations of their numbers
                if name == "migration_bytes":
                    noise = 3.0 * math.sqrt(sum(RECORD_BYTES / max(1.0, sum(run.sum(name) for run in group)) for group in (least, most)))
                if purpose in ("ghost", "halo", "migration") and growth[kind, name][2] > GROWTH + noise:
                    complaints.append(f"{kind}: {name} a rank grow by {growth[kind, name][2]:.3f} from {full[0]} to {full[-1]} ranks")
    return growth


def check_sums(runs, complaints):
    """What every rank must see alike, and what the particles add up to."""
    for (kind, ranks), found in runs.items():
        for run in found:
            where = f"{kind}, {ranks} ranks"
            for name in ("rebuilds", "reductions", "exchanges"):
                if len(set(run.of_rank(name))) != 1:
                    complaints.append(f"{where}: {name} differ from rank to rank")
            if run.sum("owned") != run.particles or run.sum("particle_steps") != run.particles * run.steps:
                complaints.append(f"{where}: particles are missing in the counters")
            if run.sum("ghost_messages") > MESSAGES * neighbours(kind, ranks) * ranks * run.steps:
                complaints.append(f"{where}: more than {MESSAGES} messages a neighbour and step")


def growth_words(growth):
    out = []
    for kind in ("slab", "pencil"):
        rows = {name: value for (k, name), value in growth.items() if k == kind}
        if rows:
            first, last, _ = next(iter(rows.values()))
            out.append(f"* {kind}, {first} to {last} ranks, a rank: " +
                       ", ".join(f"{name.replace('_', ' ')} x {value[2]:.3f}" for name, value in rows.items()) + ".")
    return out


def features(run):
    """What was counted, over all ranks, in the order of FEATURES."""
    slots = run.each("rebuilds") * (run.sum("particle_steps") + run.sum("ghost_steps")) / run.steps
    return [run.sum("particle_steps"), run.sum("pair_steps"), run.sum("ghost_steps"), slots, run.particles, run.ranks, run.ranks * run.steps if run.ranks > 1 else 0]


def time_runs(options, cases):
    """Name and runs, the one of least work first. On a busy machine more are made: ranks that wait for ranks that were not let run burn CPU
    time, so runs that did not get their cores do not count."""
    found = []
    for name, side, boundary, ranks, settings in cases:
        settings = {"container.size": f"[{side:g},{side:g},0.48]", "container.boundary": f'["{boundary}","{boundary}"]', "rest.wait": "0", **settings}
        good = []
        for attempt in range(options.attempts):
            run = start(options, f"time_{name.replace(' ', '_')}_{attempt}", measuring.ROOT / "input/million.toml", ranks, settings, attempt,
                        options.limit if ranks > 1 else None)
            good += [run] if run and run.core() >= options.core else []
            if len(good) == options.repeats:
                break
        if not good:
            sys.exit(f"scaling: {name} never got {options.core:g} of a core a rank; time it on a machine without other work")
        found.append((name, sorted(good, key=Run.work)))
    return found


def fit(found):
    """CPU seconds of each feature: non-negative least squares of relative errors."""
    import numpy as np
    from scipy.optimize import nnls
    rows = np.array([[f / runs[0].work() for f in features(runs[0])] for _, runs in found])
    scale = rows.max(axis=0)
    return nnls(rows / scale, np.ones(len(rows)))[0] / scale


def fit_table(costs, fitted, held):
    names = "| " + " | ".join(FEATURES) + " |"
    units = "| " + " | ".join(f"{c * 1e9:.3g} ns" if c < 1e-6 else f"{c * 1e6:.3g} us" if c < 1e-3 else f"{c:.3g} s" for c in costs) + " |"
    out = [names, "|---" * len(FEATURES) + "|", units, "",
           "| run | | ranks | spheres | particle-steps | ghosts a particle | CPU s of each run, less waiting | share of a core | fit | error |",
           "|---" * 10 + "|"]
    errors = {}
    for group, cases in (("fitted", fitted), ("held out", held)):
        for name, runs in cases:
            run, guess = runs[0], sum(c * f for c, f in zip(costs, features(runs[0])))
            errors[name] = guess / run.work() - 1.0
            out.append(f"| {name} | {group} | {run.ranks} | {run.particles} | {run.sum('particle_steps'):.3g} | {run.sum('ghost_steps') / run.sum('particle_steps'):.3f} | "
                       f"{', '.join(f'{r.work():.2f}' for r in runs)} | {run.core():.2f} | {guess:.2f} | {100 * errors[name]:+.1f} % |")
    worst = {group: max(abs(errors[name]) for name, _ in cases) for group, cases in (("fitted", fitted), ("held out", held))}
    return out, worst


class Cluster:
    """The assumptions about another machine, and how far they may be off: `low` is fast, `high` is slow."""

    def __init__(self, options, case, fit_error):
        slow = {"low": 0.5, "central": 1.0, "high": 2.0}[case]
        self.latency = options.latency * slow
        self.rank_bandwidth = options.network_bandwidth / options.ranks_per_node / slow
        self.memory = math.inf if case == "low" else options.node_bandwidth / options.ranks_per_node / (1.0 if case == "central" else 1.5)
        self.cache = options.cache
        self.hides = {"low": 0.5, "central": 0.25, "high": 0.0}[case]   # of the kernel, for messages under way
        self.core = 1.0 + {"low": -fit_error, "central": 0.0, "high": fit_error}[case]
        self.wait = {"low": 1.0, "central": 1.0 + options.noise, "high": 1.0 + 4.0 * options.noise}[case]


def layout(kind, ranks, side):
    """Parts on both axes, columns on both, or None if there are too few columns."""
    columns = int(side / RANGE_53)
    px, py = (ranks, 1)
    if kind == "pencil":
        px = next(p for p in range(math.isqrt(ranks), ranks + 1) if ranks % p == 0 and p >= ranks // p)
        py = ranks // px
    return (px, py, columns) if px <= columns and py <= columns else None


def predict(model, spheres, ranks, kind, cluster):
    """Wall seconds of input/million.toml with that many spheres: dict of parts, or None."""
    side = math.sqrt(spheres / model["spheres_per_area"])
    parts = layout(kind, ranks, side)
    if parts is None:
        return None
    px, py, columns = parts
    costs, steps, rebuilds = model["costs"], model["steps"], model["rebuilds"]
    share = [RANGE_53 / (side / p) if p > 1 else 0.0 for p in (px, py)]
    ghosts = 2.0 * (share[0] + share[1]) + math.pi * share[0] * share[1]
    uneven = math.prod(math.ceil(columns / p) / (columns / p) for p in (px, py))   # a rank has whole columns
    mine = spheres / ranks * uneven
    moving = model["particle_steps"] * mine                                          # particle-steps of the largest rank
    kernel = moving * (costs[0] + costs[1] * model["pairs"] * (1.0 + model["border_pairs"] * ghosts)) * cluster.core
    slots = moving / steps * (1.0 + ghosts)
    if slots * model["bytes"] > cluster.cache:
        kernel = max(kernel, moving * model["bytes_per_step"] / cluster.memory)
    partners = (3 if px > 1 else 1) * (3 if py > 1 else 1) - 1
    depth = math.ceil(math.log2(ranks)) if ranks > 1 else 0
    seconds = {"kernel": kernel, "rebuilds": slots * rebuilds * costs[3] * cluster.core, "once": (mine * costs[4] + costs[5]) * cluster.core}
    flight = moving * ghosts * LIVE_BYTES / cluster.rank_bandwidth + steps * MESSAGES * partners * cluster.latency
    hidden = min(flight, cluster.hides * kernel)   # messages travel while the kernel works
    seconds["ghosts"] = moving * ghosts * costs[2] * cluster.core + flight - hidden
    seconds["reductions"] = model["reductions"] * depth * cluster.latency
    seconds["rebuild messages"] = rebuilds * (4.0 * depth + 8.0 * partners) * cluster.latency
    seconds["waiting"] = (cluster.wait - 1.0) * sum(seconds.values())
    return {"total": sum(seconds.values()), "mine": mine, "ghost_share": ghosts, "uneven": uneven, **seconds}


def model_of(costs, held, runs):
    """What a sphere of input/million.toml does, by the largest run; what borders add, by the blocks."""
    run = max((found[0] for _, found in held if found[0].ranks == 1), key=lambda r: r.particles)
    alone, most = runs["slab", 1][0], runs["slab", max(r for _, r in runs)][0]
    pairs = [r.sum("pair_steps") / r.sum("particle_steps") for r in (alone, most)]
    listed = run.sum("pair_steps") / run.sum("particle_steps")
    return {"costs": costs, "steps": run.steps, "rebuilds": run.each("rebuilds"), "reductions": run.each("reductions"), "pairs": listed,
            "particle_steps": run.sum("particle_steps") / run.particles, "spheres_per_area": run.particles / 2.6**2,
            "border_pairs": (pairs[1] / pairs[0] - 1.0) / (most.sum("ghost_steps") / most.sum("particle_steps")),
            "bytes": run.sum("allocated") / run.particles, "bytes_per_step": 2 * 96 + 8.0 * listed}


SIZES, RANKS = (1e7, 1e8, 1e9), (100, 300, 1000, 3000, 10000)


def duration(seconds):
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"


def prediction(options, model, error):
    clusters = {case: Cluster(options, case, error) for case in ("low", "central", "high")}
    out = ["| spheres | ranks | spheres a rank | slab: ghosts a sphere | slab | slab, efficiency | pencil: ghosts a sphere | pencil | pencil, efficiency | largest part of pencil after the kernel |", "|---" * 10 + "|"]
    for spheres in SIZES:
        alone = predict({**model}, spheres, 1, "slab", clusters["low"])["total"] / clusters["low"].core
        for ranks in RANKS:
            cells = []
            for kind in ("slab", "pencil"):
                band = {case: predict(model, spheres, ranks, kind, cluster) for case, cluster in clusters.items()}
                if band["central"] is None:
                    cells += ["", "too few columns", ""]
                    continue
                middle = band["central"]
                cells += [f"{middle['ghost_share']:.2f}", f"{duration(middle['total'])} ({duration(band['low']['total'])} to {duration(band['high']['total'])})",
                          f"{alone / ranks / middle['total']:.2f}"]
            parts = {k: v for k, v in middle.items() if k not in ("total", "mine", "ghost_share", "uneven", "kernel")}
            name = max(parts, key=parts.get)
            out.append(f"| {spheres:.0e} | {ranks} | {spheres / ranks:.2g} | " + " | ".join(cells) + f" | {name}, {100 * parts[name] / middle['total']:.0f} % |")
    plot(options, model, clusters)
    return out


def plot(options, model, clusters):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    from packmpi import style
    pyplot.rcParams.update(style.LOOK)
    figure, axes = pyplot.subplots(figsize=(7.0, 4.6), layout="constrained")
    grid = [round(10 ** (2 + k / 12)) for k in range(25)]
    grid = [r if r < 64 else round(math.sqrt(r)) ** 2 for r in grid]   # square numbers: pencils of equal sides
    for spheres, colour in zip(SIZES, (style.OTHER, style.ACHIEVED, style.TARGET)):
        for kind, line in (("slab", "--"), ("pencil", "-")):
            rows = [(r, *(predict(model, spheres, r, kind, clusters[c]) for c in ("low", "central", "high"))) for r in grid]
            rows = [(r, low["total"], mid["total"], high["total"]) for r, low, mid, high in rows if mid]
            if not rows:
                continue
            x, low, mid, high = zip(*rows)
            axes.plot(x, mid, line, color=colour, label=f"{spheres:.0e} spheres, {kind}")
            if kind == "pencil":
                axes.fill_between(x, low, high, color=colour, alpha=0.15, linewidth=0)
    axes.set(xscale="log", yscale="log", xlabel="ranks", ylabel="wall time [s]", title="input/million.toml on larger floors, predicted; bands: pencil")
    axes.legend()
    figure.savefig(options.image, dpi=110)


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--only", nargs="+", choices=("counts", "timing"), default=("counts", "timing"))
    parser.add_argument("--ranks", type=int, default=64, help="most ranks of the counts")
    parser.add_argument("--samples", type=int, default=32, help="blocks that the ghosts are counted on, over seeds and ranks, at least")
    parser.add_argument("--height", type=float, default=5.0, help="of the blocks [m]")
    parser.add_argument("--repeats", type=int, default=2, help="of each timing; the least counts")
    parser.add_argument("--attempts", type=int, default=8, help="at so many repeats of which only those count that got their cores")
    parser.add_argument("--limit", type=float, default=15.0, help="of a timed run of two ranks: longer, and it did not get its cores [s]")
    parser.add_argument("--core", type=float, default=0.85, help="least share of a core that a timed rank must get")
    parser.add_argument("--latency", type=float, default=2e-6, help="of a message between nodes, and of a level of a reduction [s]")
    parser.add_argument("--network-bandwidth", type=float, default=25e9, help="of a node [B/s]")
    parser.add_argument("--ranks-per-node", type=int, default=64)
    parser.add_argument("--node-bandwidth", type=float, default=300e9, help="of a node's memory [B/s]")
    parser.add_argument("--cache", type=float, default=4e6, help="of a core, its share of the last level included [B]")
    parser.add_argument("--noise", type=float, default=0.05, help="share of a step that the slowest rank takes longer")
    parser.add_argument("--mpirun", default="mpirun")
    parser.add_argument("--program", type=Path, default=measuring.ROOT / "build/packmpi")
    parser.add_argument("--results", type=Path, default=measuring.ROOT / "results/scaling")
    parser.add_argument("--doc", type=Path, default=measuring.ROOT / "doc/scaling.md")
    parser.add_argument("--image", type=Path, default=measuring.ROOT / "doc/images/scaling.png")
    options = parser.parse_args()
    if options.quick:
        options.ranks, options.samples, options.only = min(options.ranks, 8), 1, ("counts",)
    options.program = options.program.resolve()
    options.version = subprocess.run([options.program, "--version"], stdout=subprocess.PIPE, text=True, check=True).stdout
    return options


def kept_timing(document):
    """What the page has of an earlier run."""
    _, _, rest = document.read_text().partition(f"{FITTED_TITLE}\n")
    return f"{FITTED_TITLE}\n{rest.partition('<!-- scaling: end -->')[0].rstrip()}"


def report(options, runs, complaints, growth):
    text = ["### Counted", "", f"{measuring.made_by('scripts/study/scaling.py')}; counted by the program of {runs['slab', 1][0].git}. Load when it ended: {os.getloadavg()[0]:.1f}.", "",
            *ghost_table(runs), "", *traffic_table(runs), "", *growth_words(growth), "",
            "Checks: " + ("all hold." if not complaints else "; ".join(complaints) + ".")]
    if "timing" not in options.only:
        text += ["", kept_timing(options.doc)]   # it needs a machine without other work: a rank that waits burns CPU time
    else:
        fitted, held = time_runs(options, FITTED), time_runs(options, HELD_OUT)
        costs = fit(fitted)
        table, worst = fit_table(costs, fitted, held)
        model = model_of(costs, held, runs)
        text += ["", FITTED_TITLE, "", f"{measuring.made_by('scripts/study/scaling.py')}.", "", *table, "",
                 f"Largest error: {100 * worst['fitted']:.1f} % of the fitted, {100 * worst['held out']:.1f} % of those held out.", "",
                 "### Predicted", "",
                 f"A sphere: {model['particle_steps']:.3g} particle-steps in {model['steps']} steps, {model['rebuilds']:.0f} rebuilds, {model['pairs']:.2f} listed pairs, "
                 f"{model['bytes']:.0f} bytes. A border adds {model['border_pairs']:.2f} of a particle's pairs for each ghost. Options: latency {options.latency:g} s, network "
                 f"{options.network_bandwidth:g} B/s and memory {options.node_bandwidth:g} B/s a node of {options.ranks_per_node} ranks, cache {options.cache:g} B, noise {options.noise:g}.", "",
                 *prediction(options, model, worst["held out"]), "", f"![wall time against ranks](images/{options.image.name})"]
    measuring.write_block(options.doc, "scaling", "\n".join(text))


def main():
    options = parse()
    complaints = []
    with tempfile.TemporaryDirectory() as folder:
        if options.quick:
            options.results = Path(folder)
        options.results.mkdir(parents=True, exist_ok=True)
        options.results = options.results.resolve()
        runs = count(options)
        check_sums(runs, complaints)
        check_ghosts(options, runs, complaints)
        growth = check_traffic(runs, complaints)
        print("\n".join([*ghost_table(runs), "", *traffic_table(runs), "", *growth_words(growth)]))
        if not options.quick:
            report(options, runs, complaints, growth)
    for complaint in complaints:
        print(f"scaling: {complaint}", file=sys.stderr)
    sys.exit(1 if complaints else 0)


if __name__ == "__main__":
    main()
