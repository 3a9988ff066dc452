#!/usr/bin/python3
"""Looks for the fcc lattice that the paper saw inside example 5.3 made of spheres half as large: a table in doc/analyze.md.

usage: scripts/study/fcc.py [--radii 0.02 0.01] [--regions open container]

Makes example 5.3 with each radius, rotation on and off, with layers that pass H_d and with layers that end there, by the paper's protocol, one run at a time on one rank, and has
`packmpi analyze` look at the bulk. Packs stay in results/fcc and are not made again: stop it at any time, start it
again, and remove them to have them made by another program. About half an hour.
"""
import argparse
import json
import subprocess
from pathlib import Path

import measuring

DIAGONAL = 2.0 ** 0.5   # [mean diameters] where g(r) of fcc has a peak, and that of a disordered pack a valley


def make(options, region, radius, rotation):
    """Summary and analysis of the pack."""
    folder = options.results / f"{region}_{radius:g}_{rotation}"
    pack = folder / "paper_5_3.hdf"
    scene = {"particles.radius": f'{{ distribution = "equal", value = {radius:g} }}', "dynamics.rotation": rotation,
             "layers.region": f'"{region}"'}
    if not pack.exists():
        print(f"region {region}, r = {radius:g} m, rotation {rotation}", flush=True)
        subprocess.run([options.program, measuring.ROOT / "input/paper_5_3.toml", "-q", "--restart", "auto", "-o", folder,
                        *measuring.options_of(scene)], env=measuring.ENVIRONMENT, stdout=subprocess.DEVNULL, check=True)
    subprocess.run([options.program, "analyze", pack], env=measuring.ENVIRONMENT, stdout=subprocess.DEVNULL, check=True)
    return json.loads(pack.with_suffix(".json").read_text()), json.loads(pack.with_suffix(".analysis.json").read_text())


def bin_of(curve, x):
    return int((x - curve["from"]) / curve["width"])


def row(region, radius, rotation, summary, analysis):
    got, order, g = summary["achieved"], analysis["order"], analysis["pair_distribution"]["g"]
    counted = order["counted"]
    low, high = (bin_of(g, x) for x in (1.65, 2.05))
    return (f"| {region} | {radius * 1e3:g} mm | {'on' if rotation == 'true' else 'off'} | {got['particles']} | {got['phi_bulk']:.4f} | {counted} | "
            f"{order['fcc'] * counted:.0f} | {order['hcp'] * counted:.0f} | {order['q6']:.3f} | {g['values'][bin_of(g, DIAGONAL)]:.2f} | "
            f"{max(g['values'][low:high]):.2f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--radii", type=float, nargs="+", default=[0.02, 0.01], help="[m]")
    parser.add_argument("--regions", nargs="+", default=["open", "container"], help="layers.region")
    parser.add_argument("--program", type=Path, default=measuring.ROOT / "build/packmpi")
    parser.add_argument("--results", type=Path, default=measuring.ROOT / "results/fcc")
    parser.add_argument("--doc", type=Path, default=measuring.ROOT / "doc/analyze.md")
    options = parser.parse_args()
    options.program, options.results = options.program.resolve(), options.results.resolve()
    rows = [row(region, radius, rotation, *make(options, region, radius, rotation))
            for region in options.regions for radius in options.radii for rotation in ("true", "false")]
    text = "\n".join([f"{measuring.made_by('scripts/study/fcc.py')}.", "",
                      "| region | radius | rotation | spheres | phi_bulk | of them in the bulk | fcc | hcp | q_6, mean | g at 1.41 d | g, highest at 1.65 to 2.05 d |",
                      "|---|---|---|---|---|---|---|---|---|---|---|", *rows])
    print(text)
    measuring.write_block(options.doc, "fcc", text)


if __name__ == "__main__":
    main()
