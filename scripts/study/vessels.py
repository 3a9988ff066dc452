#!/usr/bin/python3
"""How porous are beds of equal spheres in cylinders, and how does that go with the distance from the wall? Table and figure in doc/vessels.md,
doc/data/vessels.csv.

usage: scripts/study/vessels.py [--ratios D/d ...] [--seeds N] [--friction MU] [--program build/packmpi] [--set KEY=VALUE ...] [--document FILE]
       scripts/study/vessels.py --mesh [--seeds N] ...    what a vessel of 10,000 triangles costs, and how dense beds in it are, against the same of
                                                          planes or round; a block of its own in doc/vessels.md
       scripts/study/vessels.py --large [--seeds N] ...   how long a hundred thousand in a cylinder take on two ranks; a block, too

All of it: some minutes of one core. Runs are remembered in results/vessels; the table has what is there. Costs are measured anew, in turn.
"""
import argparse
import json
import math
import resource
import subprocess
import time

import numpy as np

import common
import measuring

DIAMETER = 0.01   # of the spheres [m]
RATIOS = [4.0, 5.0, 6.0, 8.0, 10.0, 12.5, 15.0, 20.0, 25.0]
PROFILE_OF = 15.0
COLUMNS = ["ratio", "seed", "friction", "spheres", "porosity", "core_porosity", "height", "floor_over_weight", "code", "seconds"]
SCENE = """fidelity = "balanced"
[container]
shape = "cylinder"
diameter = {diameter}
height = {height}
[particles]
density = 2500.0
youngs_modulus = 1.0e7
poisson_ratio = 0.25
radius = {{ distribution = "equal", value = {radius} }}
[layers]
thickness = {thickness}
fraction = 0.25
[jamming]
gravity = 9.81
[contact]
damping_ratio = 0.3
friction = {friction}
"""


def dixon(x):
    """Porosity of a bed by d/D, up to 0.5 (Dixon 1988)."""
    return 0.4 + 0.05 * x + 0.412 * x * x


def loose(x):
    """Of one that was poured loosely, up to 0.256 (Zou and Yu 1995)."""
    return 0.400 + 0.010 * (math.exp(10.686 * x) - 1.0)


def dense(x):
    """Of one that was packed densely."""
    return 0.372 + 0.002 * (math.exp(15.306 * x) - 1.0)


def de_klerk(x, bulk):
    """Porosity at a distance of x diameters from the wall (de Klerk 2003)."""
    x = np.asarray(x, float)
    near = 2.14 * x * x - 2.53 * x + 1.0
    far = bulk + 0.29 * np.exp(-0.6 * x) * np.cos(2.3 * np.pi * (x - 0.16)) + 0.15 * np.exp(-0.9 * x)
    return np.where(x <= 0.637, near, far)


def averaged(ratio, bulk):
    """Mean porosity over a circle of that many diameters of what de Klerk's profile has."""
    from_wall = np.linspace(0.0, 0.5 * ratio, 20001)
    radius = 0.5 * ratio - from_wall
    return float(np.sum(de_klerk(from_wall, bulk) * radius) / np.sum(radius))


def height_of(ratio):
    """[m]: narrow beds are higher, so that there are spheres enough."""
    return (40.0 if ratio < 8.0 else 20.0) * DIAMETER


def made(options, ratio, seed):
    """The folder of a run that is done, with its analysis."""
    folder = options.results / f"{ratio:g}_{options.friction:g}_{seed}"
    name = folder / "bed.analysis.json"
    if name.exists():
        return folder
    folder.mkdir(parents=True, exist_ok=True)
    scene = folder / "bed.toml"
    scene.write_text(SCENE.format(diameter=ratio * DIAMETER, height=height_of(ratio), radius=DIAMETER / 2, thickness=10 * DIAMETER,
                                  friction=options.friction))
    start = time.time()
    done = subprocess.run([options.program, "run", scene, "-q", "--force", "--set", f"seed={seed}", *options.set], cwd=folder, check=False,
                          env=measuring.ENVIRONMENT, capture_output=True, text=True)
    (folder / "made.json").write_text(json.dumps({"code": done.returncode, "seconds": time.time() - start}))
    if done.returncode not in (0, 3):
        common.fail(f"{scene}: {done.stdout[-300:]}{done.stderr[-300:]}")
    subprocess.run([options.program, "analyze", "bed.hdf"], cwd=folder, check=True, env=measuring.ENVIRONMENT, capture_output=True)
    return folder


def row_of(folder, ratio, seed, friction):
    """A line of the table's data."""
    summary = json.loads((folder / "bed.json").read_text())["achieved"]
    core = json.loads((folder / "bed.analysis.json").read_text())["radial_profile"]["core"]["solid_fraction"]
    run = json.loads((folder / "made.json").read_text())
    return {"ratio": ratio, "seed": seed, "friction": friction, "spheres": summary["particles"], "porosity": round(summary["porosity_bulk"], 5),
            "core_porosity": round(1.0 - core, 5) if core else "", "height": summary["height"], "floor_over_weight": round(summary["floor_force"] / summary["weight"], 4),
            "code": run["code"], "seconds": round(run["seconds"], 1)}


def janssen(ratio, height, share, friction):
    """K with which the floor of a column bears that share of the weight: (1 - exp(-x)) / x, x = 4 mu K h / D."""
    low, high = 1e-6, 1e3
    for _ in range(100):
        x = math.sqrt(low * high)
        low, high = (x, high) if (1.0 - math.exp(-x)) / x > share else (low, x)
    return low / (4.0 * friction * height / (ratio * DIAMETER))


def mean(values):
    return sum(values) / len(values)


def wide_limit(rows):
    """What the beds' porosity tends to: their mean excess over Dixon's own, above his limit of 0.4."""
    return 0.4 + mean([row["porosity"] - dixon(1.0 / row["ratio"]) for row in rows])


def conflicts(bulk):
    """What nobody's beds of 4 to 25 diameters can do, a sentence each."""
    excess = [averaged(ratio, bulk) - dixon(1.0 / ratio) for ratio in RATIOS]
    narrow, wide = RATIOS[0], RATIOS[-1]
    least = dense(1.0 / narrow) - dixon(1.0 / narrow)
    most = loose(1.0 / wide) - dixon(1.0 / wide)
    return [f"De Klerk's profile around a bulk of {bulk:.3f}, averaged over the circles, exceeds Dixon's by {max(excess):.4f} to {min(excess):.4f} from bed to bed: by "
            f"{max(excess) - min(excess):.3f}, where beds within 0.01 of Dixon's differ by 0.020 at most.",
            f"The densest bed of {narrow:g} diameters of Zou and Yu exceeds Dixon's by {least:.4f}, their loosest of {wide:g} by {most:.4f}: no bed lies between their curves at both "
            f"ends and within 0.01 of Dixon's, as {least - most:.4f} is more than 0.0200."]


def table(rows, options, bulk):
    limit = wide_limit(rows)
    lines = ["| D/d | spheres | porosity | less its wide limit | Dixon | dense, loose | de Klerk, averaged | three d from the wall | floor / weight | Janssen's K |",
             "|---|---|---|---|---|---|---|---|---|---|"]
    for ratio in sorted({row["ratio"] for row in rows}):
        of = [row for row in rows if row["ratio"] == ratio]
        x = 1.0 / ratio
        got = mean([row["porosity"] for row in of])
        core = [row["core_porosity"] for row in of if row["core_porosity"] != ""]
        curves = f"{dense(x):.3f}, {loose(x):.3f}" if x <= 0.256 else ""
        lines.append(f"| {ratio:g} | {len(of)} x {of[0]['spheres']:,} | {got:.4f} | {got - limit:.4f} | {dixon(x) - 0.4:.4f} | {curves} | "
                     f"{f'{averaged(ratio, bulk):.4f}' if bulk else ''} | {f'{mean(core):.4f}' if core else ''} | {mean([row['floor_over_weight'] for row in of]):.2f} | "
                     f"{mean([janssen(ratio, row['height'], row['floor_over_weight'], options.friction) for row in of]):.2f} |")
    lines += ["", *(conflicts(bulk) if bulk else []), "", f"Friction {options.friction:g}, wide limit {limit:.4f}. {measuring.made_by('scripts/study/vessels.py')}."]
    return "\n".join(lines)


def profiles(folders):
    """Distances from the wall [d], mean porosity of the shells there."""
    read = [json.loads((folder / "bed.analysis.json").read_text())["radial_profile"]["from_wall"] for folder in folders]
    width = read[0]["width"] / DIAMETER
    values = np.mean([one["values"] for one in read], axis=0)
    return (np.arange(len(values)) + 0.5) * width, 1.0 - values


def turns(x, y):
    """Minima and maxima in turn, beyond a quarter of a diameter: (place, value), of parabolas through three points."""
    found = []
    for k in range(1, len(x) - 1):
        bend = y[k - 1] - 2.0 * y[k] + y[k + 1]
        if x[k] > 0.25 and (y[k] - y[k - 1]) * (y[k + 1] - y[k]) < 0.0 and bend != 0.0:
            shift = 0.5 * (y[k - 1] - y[k + 1]) / bend
            found.append((x[k] + shift * (x[1] - x[0]), y[k] - 0.125 * (y[k - 1] - y[k + 1]) ** 2 / bend))
    return found


def turn_table(x, y, bulk):
    fine = np.linspace(0.0, 4.0, 4001)
    curve = turns(fine, de_klerk(fine, bulk))
    lines = ["| | at [d] | de Klerk | porosity | de Klerk |", "|---|---|---|---|---|"]
    for name, got, wanted in zip(["first minimum", "first maximum", "second minimum", "second maximum"], turns(x, y), curve):
        lines.append(f"| {name} | {got[0]:.2f} | {wanted[0]:.2f} | {got[1]:.3f} | {wanted[1]:.3f} |")
    return "\n".join(lines)


def figure(rows, x, y, bulk, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from packmpi import style
    plt.rcParams.update(style.LOOK)
    _, (left, right) = plt.subplots(1, 2, figsize=(10.5, 3.8), layout="constrained")
    share = np.linspace(0.03, 0.256, 200)
    left.fill_between(share, [dense(s) for s in share], [loose(s) for s in share], color=style.GRID, label="Zou & Yu, dense to loose")
    left.plot(share, [dixon(s) - 0.4 + wide_limit(rows) for s in share], color=style.INK, label="Dixon, at our wide limit")
    left.plot([1.0 / row["ratio"] for row in rows], [row["porosity"] for row in rows], "o", color=style.ACHIEVED, markersize=4, label="packmpi")
    left.set(xlabel="sphere over vessel, d / D", ylabel="porosity of the bulk")
    left.legend()
    fine = np.linspace(0.0, 5.0, 1000)
    right.plot(fine, de_klerk(fine, bulk), color=style.INK, label="de Klerk")
    right.plot(x[x < 5.0], y[x < 5.0], ".", color=style.ACHIEVED, label=f"packmpi, D/d = {PROFILE_OF:g}")
    right.set(xlabel="distance from the wall [d]", ylabel="porosity of the shell", ylim=(0.1, 1.0))
    right.legend()
    plt.savefig(path, dpi=110)


def quads(rows):
    """OBJ faces of a band between two rows of numbers of points: two triangles a step."""
    return [face for low, high in rows for k in range(len(low) - 1)
            for face in ((low[k], low[k + 1], high[k + 1]), (low[k], high[k + 1], high[k]))]


def obj(points, faces):
    return "".join(f"v {x:.12g} {y:.12g} {z:.12g}\n" for x, y, z in points) + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces)


def round_surface(strips, rings, radius, height):
    """An upright prism of many sides whose corners lie on a cylinder: a wall of strips, floor and lid of fans."""
    angles = 2.0 * np.pi * np.arange(strips) / strips
    points = [(radius * np.cos(a), radius * np.sin(a), height * k / rings) for k in range(rings + 1) for a in angles] + [(0, 0, 0), (0, 0, height)]
    rows = [[k * strips + j % strips for j in range(strips + 1)] for k in range(rings + 1)]
    faces = quads(list(zip(rows, rows[1:])))
    low, high = len(points) - 2, len(points) - 1
    faces += [(low, rows[0][j + 1], rows[0][j]) for j in range(strips)] + [(high, rows[-1][j], rows[-1][j + 1]) for j in range(strips)]
    return obj(points, faces)


def box_surface(cuts, side, height):
    """A box whose six sides are cut into cuts x cuts pairs of triangles."""
    points, faces, number = [], [], {}
    lengths = (side, side, height)

    def point(*at):
        if at not in number:
            number[at] = len(points)
            points.append(tuple(length * step / cuts for length, step in zip(lengths, at)))
        return number[at]

    for axis in range(3):
        for end in (0, cuts):
            grid = []
            for i in range(cuts + 1):
                row = []
                for j in range(cuts + 1):
                    at = [0, 0, 0]
                    at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3] = end, j, i
                    row.append(point(*at))
                grid.append(row if end else row[::-1])
            faces += quads(list(zip(grid, grid[1:])))
    return obj(points, faces)


MESH_SIDE, MESH_HEIGHT = 0.15, 0.15   # [m]; cylinders have that diameter
MESH_KINDS = {
    "box": (f"size = [{MESH_SIDE}, {MESH_SIDE}, {MESH_HEIGHT}]", None),
    "box of triangles": (None, lambda: box_surface(29, MESH_SIDE, MESH_HEIGHT)),
    "cylinder": (f'shape = "cylinder"\ndiameter = {MESH_SIDE}\nheight = {MESH_HEIGHT}', None),
    "cylinder of triangles": (None, lambda: round_surface(100, 49, MESH_SIDE / 2, MESH_HEIGHT)),
}


def mesh_run(options, kind, seed):
    """CPU seconds of a whole job, those of its steps with their lists, and its summary."""
    folder = options.results / "mesh" / f"{kind.replace(' ', '_')}_{seed}"
    folder.mkdir(parents=True, exist_ok=True)
    container, surface = MESH_KINDS[kind]
    if surface:
        (folder / "vessel.obj").write_text(surface())
        container = f'shape = "mesh"\nfile = "vessel.obj"\nheight = {MESH_HEIGHT}'
    text = SCENE.format(diameter=0, height=0, radius=DIAMETER / 2, thickness=0.4 * MESH_HEIGHT, friction=options.friction)
    first, last = text.index("shape ="), text.index("[particles]")
    scene = folder / "bed.toml"
    scene.write_text(text[:first] + container + "\n" + text[last:].replace("[jamming]", 'region = "container"\n[jamming]'))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([options.program, "run", scene, "-q", "--force", "--set", f"seed={seed}", *options.set], cwd=folder, check=False,
                          env=measuring.ENVIRONMENT, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in (0, 3):
        common.fail(f"{scene}: {done.stdout[-300:]}{done.stderr[-300:]}")
    report = json.loads((folder / "bed.json").read_text())
    return after.ru_utime - before.ru_utime, report["costs"]["stepping"]["sum"], report["achieved"]


def mesh_table(options):
    lines = ["| vessel | triangles | spheres | porosity | CPU, a job [s] | over that without triangles | a step of a particle, lists included [ns] | over that without triangles | over that in a box |",
             "|---|---|---|---|---|---|---|---|---|"]
    runs = {kind: [] for kind in MESH_KINDS}
    for seed in range(1, options.seeds + 1):   # in turn, so that what else the machine does falls on all
        for kind in MESH_KINDS:
            runs[kind].append(mesh_run(options, kind, seed))
    job = {kind: [1e9 * seconds / summary["particle_steps"] for seconds, _, summary in got] for kind, got in runs.items()}
    step = {kind: [stepping / summary["particle_steps"] for _, stepping, summary in got] for kind, got in runs.items()}

    def over(cost, kind, other):
        return measuring.spread([a / b for a, b in zip(cost[kind], cost[other])], 2) if kind != other else ""

    for kind, got in runs.items():
        surface, plain = MESH_KINDS[kind][1], kind.split(" of ")[0]
        lines.append(f"| {kind} | {surface().count('f ') if surface else 0:,} | {mean([s['particles'] for *_, s in got]):,.0f} | "
                     f"{measuring.spread([s['porosity_bulk'] for *_, s in got], 4)} | {measuring.spread([t for t, *_ in got], 1)} | {over(job, kind, plain)} | "
                     f"{measuring.spread(step[kind], 0)} | {over(step, kind, plain)} | {over(step, kind, 'box')} |")
    lines += ["", f"{options.seeds} seeds, friction {options.friction:g}, spheres of {1000 * DIAMETER:g} mm. {measuring.made_by('scripts/study/vessels.py --mesh')}."]
    return "\n".join(lines)


# 30 diameters wide, 124 high; as soft as the limits of overlaps allow, in layers of which four are the ten diameters that move. METIS halves a
# circle of 25 columns better than one cut does; a row of the step log every 1,200 steps.
LARGE = {"particles.youngs_modulus": "8.5e7", "contact.damping_ratio": "0.15", "contact.friction": "0.3", "layers.fraction": "0.27",
         "parallel.decomposition": "metis", "output.log_every": "0.1"}


def large_table(options):
    lines = ["| spheres | porosity | mean, worst overlap / r | particle-steps | of time: kernel, lists, waiting [%] | s, from the scene to the written pack |", "|---|---|---|---|---|---|"]
    for seed in range(1, options.seeds + 1):
        folder = options.results / "large"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "bed.toml").write_text(SCENE.format(diameter=0.6, height=2.48, radius=0.01, thickness=0.112, friction=0.3))
        words = ["mpirun", "-n", "2", "--bind-to", "core", options.program, "bed.toml", "-q", "--force", *measuring.options_of({**LARGE, "seed": seed})]
        done = subprocess.run([str(word) for word in words], cwd=folder, check=False, env=measuring.ENVIRONMENT, capture_output=True, text=True)
        if done.returncode != 0:
            common.fail(f"the cylinder of a hundred thousand ended with {done.returncode}: {done.stdout[-300:]}{done.stderr[-300:]}")
        report = json.loads((folder / "bed.json").read_text())
        got, cost = report["achieved"], {name: one["max"] for name, one in report["costs"].items()}
        lists, waiting = (100.0 * cost[name] / cost["cpu"] for name in ("rebuilding", "waiting"))
        kernel = 100.0 * (cost["stepping"] - cost["rebuilding"] - cost["waiting"] - cost["refreshing"]) / cost["cpu"]
        lines.append(f"| {got['particles']:,} | {got['porosity_bulk']:.4f} | {got['mean_overlap']:.4f}, {report['rest']['worst_overlap']['value']:.3f} | "
                     f"{got['particle_steps']:.2e} | {kernel:.0f}, {lists:.0f}, {waiting:.0f} | {report['provenance']['wall_seconds']:.0f} |")
    return "\n".join([*lines, "", f"`\"balanced\"`, spheres of 20 mm in a cylinder of 0.6 m. {measuring.made_by('scripts/study/vessels.py --large')}."])


def main():
    parser = argparse.ArgumentParser(description="Beds of equal spheres in cylinders.")
    parser.add_argument("--ratios", type=float, nargs="+", default=RATIOS, help="D/d")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--friction", type=float, default=0.24)
    parser.add_argument("--mesh", action="store_true", help="vessels of triangles instead")
    parser.add_argument("--large", action="store_true", help="a cylinder of a hundred thousand instead")
    options = measuring.study_options(parser, "vessels", "vessels.md")
    for name, table_of in (("mesh", mesh_table), ("large", large_table)):
        if not getattr(options, name):
            continue
        text = table_of(options)
        print(text)
        if options.document.exists():
            measuring.write_block(options.document, name, text)
        return
    folders = {(ratio, seed): made(options, ratio, seed) for ratio in options.ratios for seed in range(1, options.seeds + 1)}
    rows = [row_of(folder, ratio, seed, options.friction) for (ratio, seed), folder in folders.items()]
    of_profile = [folder for (ratio, _), folder in folders.items() if ratio == PROFILE_OF]
    cores = [row["core_porosity"] for row in rows if row["core_porosity"] != ""]
    bulk = mean(cores) if cores else None   # of narrow beds alone nothing is far from the wall
    text = table(rows, options, bulk)
    if of_profile:
        x, y = profiles(of_profile)
        text += "\n\n" + turn_table(x, y, bulk)
        if options.document.parent.name == "doc":
            figure(rows, x, y, bulk, options.document.parent / "images" / "vessels.png")
    print(text)
    if options.document.exists():
        measuring.write_csv(options.document.parent / "data" / "vessels.csv", COLUMNS, rows)
        measuring.write_block(options.document, "vessels", text)


if __name__ == "__main__":
    main()
