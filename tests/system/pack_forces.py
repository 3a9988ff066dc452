#!/usr/bin/python3
"""Contacts of packs against the equations of doc/theory.md, written down here once more: overlaps, normals and forces follow from what the
pack says of its particles and of what their contacts remember, between particles and at walls, and hold the weight.

usage: pack_forces.py ROOT FOLDER -- mpirun ... packmpi
Exit code 77: h5py is missing.
"""
import math
import shutil
import subprocess
import sys
from pathlib import Path

try:
    import h5py  # noqa: F401
    import numpy as np
except ImportError as error:
    print(f"skipped: the Python package {error.name} is missing (scripts/setup.sh --plots)")
    sys.exit(77)

DENSITY, E, NU, ZETA, G = 1000.0, 4.0e6, 0.25, 0.3, 9.81
MU, MU_WALL, MU_R, MU_T = 0.5, 0.3, 0.1, 0.05
SCENE = """
[container]
dimension = {dimension}
size = {size}
boundary = {boundary}
[particles]
density = 1000.0
youngs_modulus = 4.0e6
poisson_ratio = 0.25
radius = {{ distribution = "uniform", min = 0.012, max = 0.02, weighting = "number" }}
[layers]
thickness = 0.15
fraction = 0.25
duration = {duration}
maximum = 1
[jamming]
gravity = 9.81
[contact]
tangential = "{tangential}"
friction = 0.5
wall_friction = 0.3
damping_ratio = 0.3
{rolling}
[dynamics]
time_step = 1.0e-4
[rest]
wait = 0.0
[output]
contacts = true
"""
SCENES = {
    "spheres": dict(dimension=3, size=[0.2, 0.2, 0.2], boundary='["wall", "periodic"]', tangential="mindlin", duration=0.5,
                    rolling="rolling_friction = 0.1\ntwisting_friction = 0.05"),
    "slipping": dict(dimension=3, size=[0.2, 0.2, 0.2], boundary='["periodic", "wall"]', tangential="mindlin", duration=0.5, rolling=""),
    "discs": dict(dimension=2, size=[0.25, 0.3], boundary='["wall"]', duration=1.0, tangential="mindlin", rolling="rolling_friction = 0.1"),
}
problems = []


def expect(condition, words):
    if not condition:
        problems.append(words)


def near(name, got, wanted, scale):
    worst = float(np.max(np.abs(got - wanted), initial=0.0))
    expect(worst <= 1e-9 * scale, f"{name}: {worst:.3g} off, at a scale of {scale:.3g}")


def dot(a, b):
    return np.einsum("ij,ij->i", a, b)[:, None]


def forces(names, c, n, overlap, r, mass, sharing, mu, v, s, spin):
    """On the first, of all contacts at once. v, s, spin: second less first, sum of r omega, second less first."""
    E_star, G_star = E / (sharing * (1 - NU**2)), E / (2 * sharing * (1 + NU) * (2 - NU))
    a = np.sqrt(r * overlap)
    rate = -dot(v, n)
    normal = 4 / 3 * E_star * a * overlap + 2 * ZETA * np.sqrt(2 * E_star * mass * a) * rate
    normal = np.maximum(normal, 0.0)   # contact.tension_cutoff
    k = 8 * G_star * a
    damping = 2 * ZETA * np.sqrt(k * 2 / 7 * mass)

    def limited(x, u, coefficient):
        trial = k * x + damping * u
        size = np.sqrt(dot(trial, trial))
        return trial * np.minimum(1.0, coefficient * normal / np.maximum(size, 1e-300))

    xi = c["tangential_displacement"]
    near(f"{names}: xi lies in the tangent plane", dot(xi, n), 0.0, float(np.max(np.abs(xi), initial=1e-300)))
    u = v + rate * n - np.cross(s, n)
    held = float(np.mean(np.sqrt(dot(k * xi, k * xi)) < 0.99 * mu * normal))
    expect(0.05 < held, f"{names}: {held:.2f} of the contacts stick")
    if "rolling_displacement" in c:
        expect(float(np.max(np.abs(c["rolling_displacement"]), initial=0.0)) > 0.0, f"{names}: nothing rolls")
        worst = np.sqrt(dot(k * c["rolling_displacement"], k * c["rolling_displacement"])) - MU_R * normal
        expect(float(np.max(worst)) <= 0.2 * float(np.max(normal)), f"{names}: rolling springs are beyond their limit")
    return limited(xi, u, mu) - normal * n


def check(pack, size, periodic, up):
    volume = 4 / 3 * math.pi * pack.radius[:, None]**3   # of discs, too: theory.md
    mass = DENSITY * volume
    spin = pack.spin
    i, j = pack.pair_contacts["pair"].T
    d = pack.position[j] - pack.position[i]
    for axis in periodic:
        d[:, axis] -= size[axis] * np.round(d[:, axis] / size[axis])
    distance = np.sqrt(dot(d, d))
    n = d / distance
    ri, rj = pack.radius[i][:, None], pack.radius[j][:, None]
    overlap = ri + rj - distance
    name = f"{pack.name}, pairs"
    near(f"{name}: overlap", pack.pair_contacts["overlap"][:, None], overlap, 0.02 * 1e-3)
    near(f"{name}: normal", pack.pair_contacts["normal"], n, 1.0)
    reduced = mass[i] * mass[j] / (mass[i] + mass[j])
    wanted = forces(name, pack.pair_contacts, n, overlap, ri * rj / (ri + rj), reduced, 2.0, MU, pack.velocity[j] - pack.velocity[i],
                    ri * spin[i] + rj * spin[j], spin[j] - spin[i])
    near(f"{name}: force", pack.pair_contacts["force"], wanted, float(np.max(np.abs(wanted))))
    total = np.zeros_like(pack.position)
    np.add.at(total, i, pack.pair_contacts["force"])
    np.subtract.at(total, j, pack.pair_contacts["force"])

    walls, p = pack.wall_contacts, pack.wall_contacts["particle"]
    normals = np.zeros((5, 3))
    normals[0, up], normals[1, 0], normals[2, 0], normals[3, 1], normals[4, 1] = -1, -1, 1, -1, 1
    n = normals[walls["wall"]]
    axis = np.array([up, 0, 0, 1, 1])[walls["wall"]]
    x = pack.position[p, axis]
    r = pack.radius[p][:, None]
    far = np.isin(walls["wall"], (2, 4))
    overlap = (pack.radius[p] - np.where(far, np.array(list(size))[axis] - x, x))[:, None]
    name = f"{pack.name}, walls"
    near(f"{name}: overlap", walls["overlap"][:, None], overlap, 0.02 * 1e-3)
    near(f"{name}: normal", walls["normal"], n, 1.0)
    wanted = forces(name, walls, n, overlap, r, mass[p], 1.0, MU_WALL, -pack.velocity[p], r * spin[p], -spin[p])
    near(f"{name}: force", walls["force"], wanted, float(np.max(np.abs(wanted))))
    expect(set(walls["wall"]) > {0}, f"{name}: only the floor is touched")
    np.add.at(total, p, walls["force"])
    weight = G * float(np.sum(mass))
    near_weight = float(np.sum(walls["force"][:, up]))
    expect(abs(near_weight - weight) < 0.1 * weight, f"{pack.name}: floor and walls hold {near_weight:.4g} N of {weight:.4g} N")
    total[:, up] -= G * mass[:, 0]
    left = np.median(np.sqrt(dot(total, total)) / (G * mass))
    expect(left < 0.5, f"{pack.name}: half of the particles have more than {left:.2g} of their weight left over")
    return len(i), len(p)


def main():
    root, folder = Path(sys.argv[1]), Path(sys.argv[2])
    sys.path.insert(0, str(root / "scripts" / "python"))
    from packmpi import Pack
    program = sys.argv[sys.argv.index("--") + 1:]
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name, values in SCENES.items():
        scene = folder / f"{name}.toml"
        scene.write_text(SCENE.format(**values))
        done = subprocess.run([*program, str(scene), "--quiet", "-o", str(folder)], capture_output=True, text=True)
        if done.returncode not in (0, 3):
            sys.exit(f"exit code {done.returncode}:\n{done.stdout}{done.stderr}")
        pack = Pack(folder / f"{name}.hdf")
        periodic = [axis for axis, kind in enumerate(eval(values["boundary"])) if kind == "periodic"]
        pairs, walls = check(pack, values["size"], periodic, values["dimension"] - 1)
        print(f"{name}: {pairs} pairs, {walls} contacts with walls")
    print("\n".join(problems) or "all as the equations have it")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
