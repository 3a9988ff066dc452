#!/usr/bin/python3
"""What becomes of a pack in the code that receives it: packs by `packmpi convert` run on in LAMMPS, LIGGGHTS and YADE by the scripts that convert wrote:
a table in doc/rest.md, doc/data/handover.csv.

usage: scripts/study/handover.py [--steps 10000] [--scenes walls powder graded] [--codes lammps liggghts yade] [--set KEY=VALUE ...]

Packs are made twice: at rest by the usual limits of [rest], by which a single loose sphere may still roll, and by HANDED, by which none does. Sinking: loss of
phi_bulk, less than zero for a pack that rises; displacement: of the sphere that moved farthest, in mean diameters, and the mean. Kinetic energy, of
translation, is looked at every hundredth of the steps. Twenty minutes of one core, YADE most of it.
"""
import argparse
import csv
import re
import shutil
import sys

import numpy as np

import grains
import measuring
from packmpi import Pack
from settling import run

# file, changes: of the paper's kind between walls; a powder under full gravity, periodic; graded, periodic.
SCENES = {
    "walls": ("quickstart", {"container.size": "[0.4,0.4,0.35]"}),
    "powder": ("quickstart", {"container.size": '["22 mm","22 mm","22 mm"]', "container.boundary": '["periodic","periodic"]', "particles.density": "2500.0",
                              "particles.youngs_modulus": "3e7", "particles.radius": '{distribution="equal",value=0.001}', "layers.thickness": "0.008",
                              "layers.duration": "0.15", "jamming.gravity": "9.81", "contact.friction": "0.5", "drag.coefficient": "0.0",
                              "dynamics.time_step": "1e-5"}),
    "graded": ("paper_5_4", {"container.size": "[0.4,0.4,0.4]", "container.boundary": '["periodic","periodic"]', "fidelity": "balanced"}),
}
SCENES["confined"] = ("confined", {"container.size": "[0.08,0.08,0.08]", "confinement.wait": "20"})   # until its one loose sphere lies still
SCENES["cylinder"] = ("pebbles", {"container.height": "0.6"})
SCENES["mesh"] = ("hopper", {"particles.diameter": '{distribution="equal",value="40 mm"}'})
CANNOT = {("mesh", "lammps")}           # its granular walls know no triangles
SPRINGS = {"output.contacts": "true"}   # convert carries them over
# To be handed over: nothing moves any more.
HANDED = {"rest.kinetic_energy": "1e-10", "rest.unbalanced_force": "1e-4"}
CODES = ("lammps", "liggghts", "yade")
COLUMNS = ["scene", "rest", "code", "spheres", "steps", "phi_bulk", "sinking", "largest_displacement", "mean_displacement", "kinetic_first", "kinetic_peak", "kinetic_last",
           "coordination_before", "coordination_after"]
# Appended to convert's scripts: what the spheres are at the end.
DUMP = "\nwrite_dump all custom out.dump id x y z radius modify sort id format {}\n"
DIGITS = {"lammps": "float %.17g", "liggghts": '"%d %.17g %.17g %.17g %.17g"'}
YADE_END = """
energies = [utils.kineticEnergy()]
for k in range(100):
    O.run({steps} // 100, True)
    energies.append(utils.kineticEnergy())
print('ENERGIES', *energies)
with open('out.xyz', 'w') as file:
    for i in ids:
        file.write('%.17g %.17g %.17g\\n' % tuple(O.bodies[i].state.pos))
"""


def by_lammps(code, folder, script, steps):
    """Positions after the steps and the kinetic energies on the way [J]."""
    text = script.read_text()
    text = re.sub(r"(?m)^thermo  .*$", f"thermo {max(1, steps // 100)}", text)
    own = folder / f"run.{code}.in"
    own.write_text(text + DUMP.format(DIGITS[code]))
    program = {"lammps": "lmp", "liggghts": "liggghts"}[code]
    said, _ = run([program, "-in", own.name, "-var", "steps", steps, "-log", f"{code}.log"], folder, folder / f"{code}.said")
    energies = []
    for block in re.findall(r"(?m)^ *Step.*\n((?: *[-+\d].*\n)+)", said):
        energies += [float(line.split()[2]) for line in block.splitlines() if len(line.split()) >= 5]
    rows = np.array((folder / "out.dump").read_text().split("ITEM: ATOMS")[1].split("\n", 1)[1].split(), float).reshape(-1, 5)
    return rows[:, 1:4], energies


def by_yade(folder, script, steps):
    own = folder / "run.yade.py"
    text = script.read_text().replace("'PACK_STEPS', '200'", "'PACK_STEPS', '1'")   # run(0) would run for ever
    own.write_text(text + YADE_END.format(steps=steps))
    said, _ = run(["yade-batch" if shutil.which("yade") is None else "yade", "-n", "-x", own.name], folder, folder / "yade.said")
    energies = [float(word) for word in re.search(r"ENERGIES (.*)", said)[1].split()]
    return np.loadtxt(folder / "out.xyz"), energies


def received(code, folder, path, steps):
    pack = Pack(path)
    periodic = [end == "periodic" for end in pack.scene()["container"].get("boundary", ["wall", "wall"])]
    script = path.with_suffix({"lammps": ".lammps.in", "liggghts": ".liggghts.in", "yade": ".yade.py"}[code])
    position, energies = by_yade(folder, script, steps) if code == "yade" else by_lammps(code, folder, script, steps)
    moved = position - pack.position
    for axis in range(2):
        if periodic[axis]:
            moved[:, axis] -= pack.size[axis] * np.round(moved[:, axis] / pack.size[axis])
    before, after = (grains.measures(where, pack.radius, pack.size, periodic) for where in (pack.position, position))
    diameter, far = 2.0 * pack.radius.mean(), np.linalg.norm(moved, axis=1)
    mgd = pack.summary["weight"] * diameter
    return {"spheres": pack.count, "steps": steps, "phi_bulk": before["phi_bulk"], "sinking": after["phi_bulk"] / before["phi_bulk"] - 1.0,
            "largest_displacement": far.max() / diameter, "mean_displacement": far.mean() / diameter, "kinetic_first": energies[0] / mgd,
            "kinetic_peak": max(energies) / mgd, "kinetic_last": energies[-1] / mgd, "coordination_before": before["coordination"],
            "coordination_after": after["coordination"]}


def measure(options, name, rest):
    file, changes = SCENES[name]
    if rest == "handed":
        changes = {**changes, **HANDED}
    changes = {**changes, **SPRINGS}
    folder = options.results / f"{name}_{rest}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    scene = measuring.bare_scene(file, folder, ["regularisation"]) if file.startswith("paper") else measuring.ROOT / f"input/{file}.toml"
    words = measuring.options_of(changes) + [word for change in options.set for word in ("--set", change)]
    run([options.program, scene, "-q", "-o", folder, *words], folder, folder / "packmpi.said")
    path = folder / f"{file}.hdf"
    rows = []
    for code in options.codes:
        if (name, code) in CANNOT:
            continue
        run([options.program, "convert", path, "--to", code], folder, folder / "convert.said")
        row = {"scene": name, "rest": rest, "code": code, **received(code, folder, path, options.steps)}
        rows.append({key: f"{value:.5g}" if isinstance(value, float) else value for key, value in row.items()})
        print(", ".join(f"{key} {value}" for key, value in rows[-1].items()), flush=True)
    return rows


def with_kept(path, rows):
    """These rows and, of other scenes, limits and codes, those of before, in the order of a whole run."""
    def key(row):
        return row.get("rest") or "usual", row["scene"], row["code"]
    before = list(csv.DictReader(path.open())) if path.exists() else []
    all_of_them = {key(row): {"rest": "usual", **row} for row in [*before, *rows]}
    order = [(rest, scene, code) for rest in ("usual", "handed") for scene in SCENES for code in CODES]
    return [all_of_them[one] for one in order if one in all_of_them]


def table(rows):
    names = {"lammps": "LAMMPS", "liggghts": "LIGGGHTS", "yade": "YADE"}
    out = ["| scene, spheres | at rest by | in | sinking of phi_bulk | largest, mean displacement / d | KE / (m g d): first, peak, last | coordination |", "|---|---|---|---|---|---|---|"]
    for row in rows:
        out.append(f"| {row['scene']}, {row['spheres']} | {'1e-10, 1e-4' if row['rest'] == 'handed' else 'the usual limits'} | {names[row['code']]} | {100.0 * float(row['sinking']):+.3f} % | "
                   f"{float(row['largest_displacement']):.2g}, {float(row['mean_displacement']):.2g} | {float(row['kinetic_first']):.1e}, "
                   f"{float(row['kinetic_peak']):.1e}, {float(row['kinetic_last']):.1e} | {float(row['coordination_before']):.3f} to "
                   f"{float(row['coordination_after']):.3f} |")
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=10000)
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--rest", nargs="+", choices=("usual", "handed"), default=("usual", "handed"), help="by which limits packs are at rest")
    parser.add_argument("--codes", nargs="+", choices=CODES, default=CODES)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="change the scenes")
    parser.add_argument("--program", type=lambda text: measuring.Path(text).resolve(), default=measuring.ROOT / "build/packmpi")
    parser.add_argument("--results", type=lambda text: measuring.Path(text).resolve(), default=measuring.ROOT / "results/handover")
    parser.add_argument("--doc", type=lambda text: measuring.Path(text).resolve(), default=measuring.ROOT / "doc")
    options = parser.parse_args()
    missing = [program for code, program in zip(CODES, ("lmp", "liggghts", "yade")) if code in options.codes and shutil.which(program) is None]
    if missing:
        sys.exit(f"handover: not installed: {' '.join(missing)}; scripts/setup.sh --peers, or Debian's packages")
    rows = [row for rest in options.rest for name in options.scenes for row in measure(options, name, rest)]
    rows = with_kept(options.doc / "data/handover.csv", rows)
    measuring.write_csv(options.doc / "data/handover.csv", COLUMNS, rows)
    print("\n".join(table(rows)))
    if (options.doc / "rest.md").exists():
        measuring.write_block(options.doc / "rest.md", "handover", "\n".join([f"{measuring.made_by('scripts/study/handover.py')}. {options.steps} steps; rows are of the runs of that day or before.", "", *table(rows)]))


if __name__ == "__main__":
    main()
