#!/usr/bin/python3
"""Packs at rest against friction: packmpi beside LAMMPS and a small serial program from the same start positions by the same law, beside independent
numbers and published limits: tables in doc/rest.md, doc/data/rest.csv, doc/images/rest.svg.

usage: scripts/study/rest.py [--parts curve lammps serial stiffness layers] [--seeds N] [--mu ...] [--report-only]

  curve      packmpi, friction 0.001 to 10, four seeds, and once with rolling and twisting friction     20 minutes of one core
  lammps     LAMMPS at four of these, from the same positions (Debian's package lammps)                 20 minutes
  serial     peers/settle.cpp at the same, one seed                                                     10 minutes
  stiffness  what overlaps add: the smoothest and the roughest with other moduli                        10 minutes
  layers     the walled piles whose densities were computed elsewhere                                    3 minutes
Runs are remembered in results/rest: stop it at any time, start it again.
"""
import argparse
import csv
import statistics
from pathlib import Path

import rest_report
from settling import HERE, Workshop, measuring

SCENE = HERE / "rest.toml"
MUS = (0.001, 0.01, 0.03, 0.1, 0.2, 0.5, 1.0, 10.0)
BESIDE = (0.001, 0.1, 0.5, 10.0)   # where other codes settle the same spheres
ROUGH = {"contact.rolling_friction": "0.2", "contact.twisting_friction": "0.2"}   # with friction 0.5
MODULI = {"1e7": "4e-5", "1e9": "6.4e-6"}   # [Pa]: time step [s]; the scene itself has 1e8
PARTS = ("curve", "lammps", "serial", "stiffness", "layers")
# "Independent numbers": example 5.3 on a quarter of its floor, eleven layers, friction with memory.
LAYERS = {"container.size": "[0.5,0.5,0.5]", "layers.maximum": "11", "fidelity": "paper"}
COLUMNS = ["part", "code", "mu", "rolling", "modulus", "seed", "spheres", "phi_bulk", "coordination", "coordination_bulk", "core_4", "outside_4", "core_3",
           "outside_3", "core_2", "outside_2", "overlap", "kinetic", "top", "cpu_seconds"]


def memory(mu, rough=False, more=()):
    """Friction with memory. Without friction only the normal damping ends motion, and that takes longer."""
    return {"contact.tangential": "mindlin", "contact.friction": str(mu), "rest.wait": "0", **(ROUGH if rough else {}), **({"layers.duration": "1.0"} if mu < 0.02 else {}),
            **dict(more)}


def planned(options):
    """(part, code, scene, changes, seed) of the parts asked for."""
    seeds, beside = range(1, options.seeds + 1), [mu for mu in options.mu if mu in BESIDE]
    for seed in seeds:
        yield from (("curve", "packmpi", SCENE, memory(mu), seed) for mu in options.mu)
        yield from (("lammps", "LAMMPS", SCENE, memory(mu), seed) for mu in beside)
        for part, code in (("curve", "packmpi"), ("lammps", "LAMMPS"), ("serial", "serial")):
            if code != "serial" or seed == 1:
                yield part, code, SCENE, memory(0.5, rough=True), seed
    yield from (("serial", "serial", SCENE, memory(mu), 1) for mu in beside)
    for modulus, step in MODULI.items():
        for mu in (MUS[0], MUS[-1]):
            stiff = {"particles.youngs_modulus": modulus, "dynamics.time_step": step}
            yield from (("stiffness", "packmpi", SCENE, memory(mu, more=stiff), seed) for seed in range(1, min(2, options.seeds) + 1))
    for mu in rest_report.INDEPENDENT:
        for seed in range(1, min(2, options.seeds) + 1):
            yield "layers", "packmpi", measuring.bare_scene("paper_5_3", options.results, ["regularisation"]), memory(mu, more=LAYERS), seed


def row_of(workshop, part, code, scene, changes, seed):
    measures = workshop.settled(code, scene, changes, seed)
    return {"part": part, "code": code, "mu": float(changes["contact.friction"]), "rolling": changes.get("contact.rolling_friction", "0"),
            "modulus": changes.get("particles.youngs_modulus", "1e8"), "seed": seed,
            **{key: f"{value:.6g}" for key, value in measures.items()}}


def measure(options):
    workshop, rows = Workshop(options.program, options.results), []
    todo = [one for one in planned(options) if one[0] in options.parts]
    for k, one in enumerate(todo):
        row = row_of(workshop, *one)
        rows.append(row)
        print(f"{k + 1}/{len(todo)} {row['part']} {row['code']}, friction {row['mu']:g}, rolling {row['rolling']}, E {row['modulus']}, seed {row['seed']}: "
              f"phi_bulk {float(row['phi_bulk']):.4f}, Z {float(row['coordination']):.3f}, {float(row['cpu_seconds']):.0f} s", flush=True)
    return rows


def merged(path, rows):
    """The rows of the file with these in place of theirs of the same run."""
    def identity(row):
        return tuple(str(row[key]) for key in COLUMNS[:6])
    old = []
    if path.exists():
        with open(path, newline="", encoding="utf-8") as file:
            old = list(csv.DictReader(file))
    fresh = {identity(row) for row in rows}
    return sorted([row for row in old if identity(row) not in fresh] + rows, key=lambda row: (PARTS.index(row["part"]), float(row["mu"]), identity(row)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=PARTS)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--mu", type=float, nargs="+", default=MUS)
    parser.add_argument("--report-only", action="store_true", help="report on the rows there are")
    parser.add_argument("--program", type=Path, default=measuring.ROOT / "build/packmpi")
    parser.add_argument("--results", type=Path, default=measuring.ROOT / "results/rest")
    parser.add_argument("--doc", type=Path, default=measuring.ROOT / "doc")
    options = parser.parse_args()
    data = options.doc / "data/rest.csv"
    rows = merged(data, [] if options.report_only else measure(options))
    measuring.write_csv(data, COLUMNS, rows)
    rest_report.write(options.doc, rows)


if __name__ == "__main__":
    main()
