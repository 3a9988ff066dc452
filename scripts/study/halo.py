#!/usr/bin/python3
"""How much of the ghosts' flight is hidden behind the kernel: runs of two ranks in which ghosts seem to travel for a while
(build/tests/bench/libpackmpi_slow_halo.so, preloaded), into doc/performance.md.

usage: scripts/study/halo.py [--side 1.0] [--runs 3] [--flights 0 20 50 100 200]

The floor of input/million.toml is made --side m wide and periodic. A step waits for its reduction as before, and for ghosts only
if their flight is longer than the work there is in between. Wants a core for each rank.
"""
import argparse
import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import measuring


def run(options, flight, folder):
    """Seconds a step: in the steps, rebuilds left out, and of them in refreshes; spheres."""
    done = subprocess.run(["mpirun", "--bind-to", "core", "-n", "2", "-x", "LD_PRELOAD", "-x", "PACKMPI_FLIGHT", options.program,
                           measuring.ROOT / "input/million.toml", "-q", "--force", "-o", folder,
                           *measuring.options_of({"container.size": f"[{options.side:g},{options.side:g},0.48]",
                                                  "container.boundary": '["periodic","periodic"]'})],
                          env={**measuring.ENVIRONMENT, "LD_PRELOAD": str(options.library), "PACKMPI_FLIGHT": f"{flight * 1e-6:g}"},
                          stdout=subprocess.DEVNULL, check=False)
    if done.returncode not in (0, 3):
        sys.exit(f"halo: a run ended with exit code {done.returncode}")
    summary = json.loads((Path(folder) / "million.json").read_text())
    steps, costs = summary["achieved"]["steps"], {name: summary["costs"][name]["sum"] * 0.5e-9 for name in ("stepping", "rebuilding", "refreshing")}
    return (costs["stepping"] - costs["rebuilding"]) / steps, costs["refreshing"] / steps, summary["achieved"]["particles"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--side", type=float, default=1.0, help="of the floor [m]")
    parser.add_argument("--runs", type=int, default=3, help="of each flight, in turn")
    parser.add_argument("--flights", type=float, nargs="+", default=[0, 20, 50, 100, 200, 400], help="of a message [us]")
    parser.add_argument("--program", type=Path, default=measuring.ROOT / "build/packmpi")
    parser.add_argument("--library", type=Path, default=measuring.ROOT / "build/tests/bench/libpackmpi_slow_halo.so")
    parser.add_argument("--doc", type=Path, default=measuring.ROOT / "doc/performance.md")
    options = parser.parse_args()
    options.program, options.library = options.program.resolve(), options.library.resolve()
    found = {flight: [] for flight in options.flights}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(options.runs):
            for flight in options.flights:
                found[flight].append(run(options, flight, folder))
    first = statistics.median(step for step, _, _ in found[options.flights[0]])
    lines = [f"{measuring.made_by('scripts/study/halo.py')}. {found[options.flights[0]][0][2]:,} spheres on two ranks, {options.runs} runs of each flight in turn; median "
             "(least to most), us a step without rebuilds.", "",
             "| flight of ghosts, us | a step, us | of it sending, waiting for and taking in ghosts | longer than without flight, of the flight |", "|---|---|---|---|"]
    for flight, runs in found.items():
        step, refresh = (measuring.spread([r[k] for r in runs], 1, 1e6) for k in (0, 1))
        longer = (statistics.median(r[0] for r in runs) - first) / (flight * 1e-6) if flight > options.flights[0] else 0.0
        lines.append(f"| {flight:g} | {step} | {refresh} | {100.0 * longer:.0f} % |")
    print("\n".join(lines))
    measuring.write_block(options.doc, "halo", "\n".join(lines))


if __name__ == "__main__":
    main()
