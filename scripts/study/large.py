#!/usr/bin/python3
"""Makes the large packs and writes their figures into doc/performance.md: input/million.toml with its preset
and with the paper's, input/ten_million.toml, input/cube_million.toml, and input/tall.toml to growing heights.

usage: scripts/study/large.py [--ranks 2] [--scale 1.0] [--only million paper ten cube tall] [--picture]

--scale s: the lateral extents of all but the tall ones times s, to try it (0.32: 1e5 spheres for a million). Results are kept in results/large and not
made anew while the program and the settings are the same. --picture draws the million (packmpi render).
"""
import argparse
import json
import resource
import subprocess
import sys
import time
from pathlib import Path

import measuring

PAPER = {"fidelity": "paper", "contact.tangential": "sliding"}
CASES = ("million", "paper", "ten", "cube", "tall")
SIDE, HEIGHT = 10.58, 0.48   # [m] of input/million.toml
TEN = 33.46                  # [m] of input/ten_million.toml
CUBE = 3.84                  # [m] of input/cube_million.toml
TALL = (0.25, 0.5, 1.0, 2.0)  # [m]
TALL_RUNS = 5


def cases(options):
    """Name, scene, settings of each run asked for."""
    side = SIDE * options.scale
    size = {"container.size": f"[{side:g},{side:g},{HEIGHT}]"}
    runs = []
    if "million" in options.only:
        runs.append(("million", "million", size, options.ranks))
    if "paper" in options.only:
        runs.append(("paper", "million", {**size, **PAPER}, options.ranks))
    if "ten" in options.only:
        side = TEN * options.scale
        runs.append(("ten", "ten_million", {"container.size": f"[{side:g},{side:g},{HEIGHT}]"}, options.ranks))
    if "cube" in options.only:
        side = CUBE * options.scale
        runs.append(("cube", "cube_million", {"container.size": f"[{side:g},{side:g},{CUBE}]"}, options.ranks))
    if "tall" in options.only:
        runs += [(f"tall_{height:g}", "tall", {"container.size": f"[0.6,0.6,{height:g}]"}, 1) for height in TALL]
    return runs


def make(options, name, scene, settings, ranks):
    """The figures of a run, from its results if it was made before. Short ones are made several times: the quickest counts."""
    folder = options.results / name
    kept = folder / "figures.json"
    key = [measuring.commit(), scene, settings, ranks]
    if kept.exists() and json.loads(kept.read_text())["key"] == key:
        return json.loads(kept.read_text())
    figures = min((run(options, folder, scene, settings, ranks) for _ in range(TALL_RUNS if scene == "tall" else 1)), key=lambda f: f["own"])
    figures = {"key": key, **figures}
    kept.write_text(json.dumps(figures, indent=1))
    print(f"{name}: {figures['particles']} spheres in {figures['wall']:.1f} s", flush=True)
    return figures


def run(options, folder, scene, settings, ranks):
    folder.mkdir(parents=True, exist_ok=True)
    start = time.monotonic()
    done = subprocess.run(["mpirun", "-n", str(ranks), options.program, measuring.ROOT / f"input/{scene}.toml", "-q", "--force",
                           "-o", folder, *measuring.options_of(settings)], env=measuring.ENVIRONMENT,
                          stdout=subprocess.DEVNULL, check=False)
    wall = time.monotonic() - start
    if done.returncode not in (0, 3):
        sys.exit(f"large: {folder.name} ended with exit code {done.returncode}")
    summary = json.loads((folder / f"{scene}.json").read_text())
    return {"ranks": ranks, "wall": wall, "own": summary["provenance"]["wall_seconds"],
            "peak": resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024.0, "layers": len(summary["layers"]),
            "bytes": summary["provenance"].get("bytes_per_particle"), **summary["achieved"]}


def million_table(words, f):
    """One run's figures."""
    return ["| protocol | spheres | layers | ranks | wall | particle-steps | a second of wall | MB, largest process | phi_bulk | coordination | mean overlap / r |",
            "|---|---|---|---|---|---|---|---|---|---|---|",
            f"| {words} | {f['particles']:,} | {f['layers']} | {f['ranks']} | {f['wall'] / 60.0:.1f} min | {f['particle_steps']:.3g} | "
            f"{f['particle_steps'] / f['wall'] * 1e-6:.1f}e6 | {f['peak']:.0f} | {f['phi_bulk']:.4f} | {f['coordination']:.3f} | "
            f"{f['mean_overlap']:.3e} |"]


def tall_table(found):
    rows = [figures for name, figures in found.items() if name.startswith("tall")]
    cost = [f["own"] / f["particles"] for f in rows]
    out = [f"Least of {TALL_RUNS} runs; seconds are the program's own, from the scene to the written pack, without the start of MPI.", "",
           "| height, m | layers | spheres | particle-steps a sphere | s | s a sphere |", "|---|---|---|---|---|---|"]
    for f, each in zip(rows, cost):
        out.append(f"| {f['height']:.3f} | {f['layers']} | {f['particles']:,} | {f['particle_steps'] / f['particles']:.3g} | {f['own']:.2f} | {each:.2e} |")
    return out + ["", f"The dearest sphere costs {max(cost) / min(cost):.2f} times the cheapest."]


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--scale", type=float, default=1.0)
    parser.add_argument("--only", nargs="+", choices=CASES, default=CASES)
    parser.add_argument("--picture", action="store_true")
    parser.add_argument("--program", type=Path, default=measuring.ROOT / "build/packmpi")
    parser.add_argument("--results", type=Path, default=measuring.ROOT / "results/large")
    parser.add_argument("--doc", type=Path, default=measuring.ROOT / "doc/performance.md")
    options = parser.parse_args()
    options.program, options.results = options.program.resolve(), options.results.resolve()
    return options


def main():
    options = parse()
    found = {name: make(options, name, scene, settings, ranks) for name, scene, settings, ranks in cases(options)}
    made = measuring.made_by("scripts/study/large.py" + ("" if options.scale == 1.0 else f" --scale {options.scale:g}"))
    tables = {"million": lambda: million_table("`\"balanced\"`, as in the file", found["million"]),
              "paper": lambda: million_table("`\"paper\"`", found["paper"]),
              "ten": lambda: million_table("`\"draft\"`, as in the file", found["ten"]),
              "cube": lambda: million_table("`\"balanced\"`, as in the file", found["cube"]), "tall": lambda: tall_table(found)}
    for name in options.only:   # a block each, of one date and commit
        text = "\n".join([f"{made}.", "", *tables[name]()])
        print(text)
        measuring.write_block(options.doc, f"large {name}", text)
    if options.picture and "million" in found:
        subprocess.run([options.program, "render", options.results / "million/million.hdf", "-o",
                        measuring.ROOT / "doc/images/million.png"], check=True)


if __name__ == "__main__":
    main()
