#!/usr/bin/python3
"""Three strata of two components, input/strata.toml: what came of what was asked, the same bits on any number of ranks and after a kill, and how the pack lies in
LAMMPS, LIGGGHTS and YADE. Tables in doc/howto_strata.md.

usage: scripts/study/strata.py [--ranks 1 2 3 8] [--steps 1000] [--codes lammps liggghts yade] [--program build/packmpi] [--set KEY=VALUE ...] [--document FILE]

The pack that is handed over has strata by height and is at rest by sharper limits (HANDED); those that are compared have strata by mass and little time (SHORT). Masses are
read from the rows of the pack. Killed: a run on one rank by SIGKILL, as soon as there is a checkpoint of
its third layer or later, and continued on two. Runs are remembered in results/strata. Twenty minutes of two cores that are free, YADE a third of it.
"""
import argparse
import json
import os
import re
import shutil
import signal
import subprocess
import time

import numpy as np

import common
import handover
import measuring
from packmpi import Pack

SCENE = measuring.ROOT / "input/strata.toml"
# What is compared on all ranks: strata of these masses [kg], about those of the scene, and layers that hardly settle, so that steps are few.
MASSES = [3.9, 3.9, 4.6]
SHORT = {"layers.duration": "0.02", "rest.wait": "0"}
HANDED = {"rest.kinetic_energy": "1e-7", "rest.unbalanced_force": "1e-3", "output.contacts": "true"}


def by_mass(options):
    """The scene with strata that end with masses in place of heights."""
    masses, text = iter(MASSES), SCENE.read_text()
    text = re.sub(r"(?m)^top = .*$", "", text)
    text = re.sub(r"(?m)^\[\[stratum\]\]$", lambda _: f"[[stratum]]\nmass = {next(masses)}", text)
    path = options.results / "by_mass" / SCENE.name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def command(options, ranks, folder, scene, *more):
    start = ["mpirun", "-n", ranks] if ranks > 1 else []
    words = [*start, options.program, scene, "-q", "-o", folder, *options.set, *more]
    return [str(word) for word in words]


def finished(done, words):
    if done.returncode not in (0, 3):
        common.fail(f"{' '.join(words)}: code {done.returncode}\n{done.stdout[-500:]}{done.stderr[-500:]}")
    return done.returncode


def made(options, name, ranks, scene, *more):
    """Folder of a whole run; its code and seconds are in made.json."""
    folder = options.results / name
    if not (folder / "made.json").exists():
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        words, start = command(options, ranks, folder, scene, *more), time.time()
        code = finished(subprocess.run(words, env=measuring.ENVIRONMENT, capture_output=True, text=True, check=False), words)
        (folder / "made.json").write_text(json.dumps({"code": code, "seconds": time.time() - start}))
    return folder


def killed(options):
    """Folder of a run that was killed and continued."""
    folder = options.results / "killed"
    if (folder / "made.json").exists():
        return folder
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    every = measuring.options_of({**SHORT, "checkpoint.every": '"5s"'})
    with subprocess.Popen(command(options, 1, folder, by_mass(options), *every), env=measuring.ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True) as process:
        manifest, layer = folder / "strata.ckpt.json", 0
        while process.poll() is None and layer < 3:
            time.sleep(1.0)
            layer = int((re.search(r'"layer": *(\d+)', manifest.read_text()) or [0, 0])[1]) if manifest.exists() else 0
        if process.poll() is not None:
            common.fail("the run came to its end before it could be killed")
        os.killpg(process.pid, signal.SIGKILL)
    words = command(options, 2, folder, by_mass(options), *every, "--restart", "auto")
    code = finished(subprocess.run(words, env=measuring.ENVIRONMENT, capture_output=True, text=True, check=False), words)
    (folder / "made.json").write_text(json.dumps({"code": code, "layer": layer}))
    return folder


def digest(options, folder):
    done = subprocess.run([options.program, "info", folder / "strata.hdf"], env=measuring.ENVIRONMENT, capture_output=True, text=True, check=True)
    return re.search(r"digest of the particles (\w+)", done.stdout)[1]


def densities(pack):
    return [one["density"] for one in pack.scene()["component"]]


def what_came(folder):
    """Masses of components and heights of boundaries."""
    pack, said = Pack(folder / "strata.hdf"), json.loads((folder / "strata.json").read_text())["composition"]
    density = densities(pack)
    volume = 4.0 / 3.0 * np.pi * pack.radius ** 3
    out = ["| | asked for | got | difference | its largest sphere |", "|---|---|---|---|---|"]
    for k, one in enumerate(said["components"]):
        mine = pack.component == k
        mass, largest = float((volume[mine]).sum()) * density[k], float(volume[mine].max()) * density[k]
        exact = abs(mass - one["target_mass"]) <= largest
        out.append(f"| {one['name']} [g] | {1e3 * one['target_mass']:.4f} | {1e3 * mass:.4f} | {1e3 * (mass - one['target_mass']):+.4f} | {1e3 * largest:.4f}{'' if exact else ', MISSED'} |")
    mean = 2.0 * float(pack.radius.mean())
    for at in (one for one in said["boundaries"] if "target_height" in one):
        off = at["height"] - at["target_height"]
        out.append(f"| boundary of {at['below']} and {at['above']} [mm] | {1e3 * at['target_height']:.1f} | {1e3 * at['height']:.2f} | {1e3 * off:+.2f}, {off / mean:+.2f} d | mixed over {1e3 * at['mixed_depth']:.2f} |")
    return pack, out


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ranks", type=int, nargs="*", default=[1, 2, 3, 8])
    parser.add_argument("--steps", type=int, default=1000)
    parser.add_argument("--codes", nargs="*", choices=handover.CODES, default=handover.CODES)
    options = measuring.study_options(parser, "strata", "howto_strata.md")
    digests = {f"{ranks} rank{'s' if ranks > 1 else ''}": digest(options, made(options, f"on_{ranks}", ranks, by_mass(options), *measuring.options_of(SHORT))) for ranks in options.ranks}
    digests["killed on 1, continued on 2"] = digest(options, killed(options))
    bits = what_came(options.results / "killed")
    same = "the same" if len(set(digests.values())) == 1 else "NOT the same"
    print(digests, flush=True)
    folder = made(options, "handed", 1, SCENE, *measuring.options_of(HANDED))
    pack, text = what_came(folder)
    code = json.loads((folder / "made.json").read_text())["code"]
    rows = [{"code": name, **received(options, name, folder)} for name in options.codes]
    text = [f"{measuring.made_by('scripts/study/strata.py')}. {pack.count:,} spheres, code {code}, phi_bulk {pack.phi_bulk:.4f}.", "", *text, "",
            f"By mass, {' + '.join(f'{mass:g}' for mass in MASSES)} kg, {bits[0].count:,} spheres in layers of {SHORT['layers.duration']} s:", "", *bits[1][:4], "",
            f"Digests of the particles are {same}: {', '.join(f'{name} `{value}`' for name, value in digests.items())}.", "",
            f"{options.steps} steps in other codes, types of two materials and their pairs:", "", *code_table(rows)]
    print("\n".join(text))
    if options.document.exists():
        measuring.write_block(options.document, "strata", "\n".join(text))


def received(options, code, folder):
    """What became of the pack in another code."""
    path = folder / f"{code}.{options.steps}.json"
    if not path.exists():
        subprocess.run([options.program, "convert", folder / "strata.hdf", "--to", code, "--force"], env=measuring.ENVIRONMENT, capture_output=True, check=True)
        path.write_text(json.dumps({name: float(value) for name, value in handover.received(code, folder, folder / "strata.hdf", options.steps).items()}))
    return json.loads(path.read_text())


def code_table(rows):
    names = {"lammps": "LAMMPS", "liggghts": "LIGGGHTS", "yade": "YADE"}
    out = ["| in | largest, mean displacement / d | KE / (m g d): first, peak, last | sinking of phi_bulk | coordination |", "|---|---|---|---|---|"]
    for row in rows:
        out.append(f"| {names[row['code']]} | {row['largest_displacement']:.2g}, {row['mean_displacement']:.2g} | {row['kinetic_first']:.1e}, {row['kinetic_peak']:.1e}, "
                   f"{row['kinetic_last']:.1e} | {100.0 * row['sinking']:+.3f} % | {row['coordination_before']:.3f} to {row['coordination_after']:.3f} |")
    return out


if __name__ == "__main__":
    main()
