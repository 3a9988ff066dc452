"""What the scripts that read packs share: the pack file, its time series, its analysis, and the sizes its scene asked for."""
import csv
import json
import shutil
import subprocess
import tomllib
from pathlib import Path

import common
from common import fail

try:
    import h5py
    import numpy as np
except ImportError as error:
    common.missing(error.name, "plots")


def plain(value):
    """Attributes as Python has them: texts come as str or as bytes, depending on the version of h5py."""
    if isinstance(value, bytes):
        return value.decode(errors="replace")
    return value.tolist() if isinstance(value, (np.generic, np.ndarray)) else value


def attributes(group):
    return {name: plain(value) for name, value in group.attrs.items()}


class Pack:
    """A pack file; doc/file_format.md."""

    def __init__(self, path):
        self.path = Path(path)
        try:
            with h5py.File(path, "r") as file:
                if plain(file.attrs.get("format")) != "packmpi-pack":
                    fail(f"{path} is not a pack of packmpi (root attribute 'format')")
                self.read(file)
        except OSError as error:
            fail(f"cannot read {path}: {error}")
        except KeyError as error:
            fail(f"{path} is incomplete: {error}")

    def read(self, file):
        particles = file["particles"]
        self.position = particles["position"][:]
        self.radius = particles["radius"][:]
        self.layer = particles["layer"][:]
        self.contacts = particles["contacts"][:]
        self.speed = np.linalg.norm(particles["velocity"][:], axis=1)
        self.summary = attributes(file["summary"])
        self.audit = attributes(file["summary/audit"])
        self.layers = {name: data[:].tolist() for name, data in file["summary/layers"].items()}
        self.provenance = attributes(file["provenance"])
        self.size = np.array(self.summary["size"], dtype=float)  # lateral extents, then the target height [m]
        self.dimension = self.summary["dimension"]
        self.phi, self.phi_bulk = self.summary["phi"], self.summary["phi_bulk"]
        self.pairs = file["contacts/pair"][:] if "contacts" in file else None
        self.forces = file["contacts/force"][:] if "contacts" in file else None

    @property
    def count(self):
        return len(self.radius)

    @property
    def noun(self):
        return "spheres" if self.dimension == 3 else "discs"

    @property
    def name(self):
        return self.path.stem

    def top(self):
        """Highest particle top, at least the target height [m]."""
        vertical = self.dimension - 1
        highest = (self.position[:, vertical] + self.radius).max() if self.count else 0.0
        return max(highest, self.size[vertical])

    def scene(self):
        """The scene with every default, in SI units."""
        return tomllib.loads(self.provenance["effective_input"])

    def steps(self):
        """Columns of the time series by name without unit, or nothing if the file is not beside the pack."""
        try:
            with open(self.path.with_suffix(".steps.csv"), newline="") as file:
                rows = list(csv.reader(file))
        except OSError:
            return {}
        columns = np.array(rows[1:], dtype=float).T
        return {name.split(" [")[0]: column for name, column in zip(rows[0], columns)} if len(rows) > 1 else {}

    def analysis(self, program=None):
        """What `packmpi analyze` says of the pack. It is run unless its file is there and newer than pack and program."""
        found = self.path.with_suffix(".analysis.json")
        program = program or program_here()
        newest = max(Path(one).stat().st_mtime for one in (self.path, program) if one)
        if not found.exists() or found.stat().st_mtime < newest:
            if program is None:
                fail(f"{found} is missing, and no packmpi to make it: scripts/build.sh, or --program")
            done = subprocess.run([str(program), "analyze", str(self.path)], env=common.ENVIRONMENT, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            if done.returncode != 0:
                fail(f"packmpi analyze {self.path} ended with code {done.returncode}:\n{done.stdout}")
        return json.loads(found.read_text())


def program_here():
    """The program that was built here, else the one that is installed, else None."""
    built = common.ROOT / "build" / "packmpi"
    return str(built) if built.exists() else shutil.which("packmpi")


def target_curve(radius):
    """Radii [m] and the shares of the number and of the mass up to them, of a scene's [particles.radius]: what
    scene::SizeCurve computes, to be drawn. A jump is two points at one radius."""
    kind, by_mass = radius["distribution"], radius.get("weighting") == "mass"
    if kind in ("equal", "bidisperse", "discrete"):
        r, share = {"equal": lambda: ([radius["value"]], [1.0]),
                    "bidisperse": lambda: ([radius["small"], radius["large"]],
                                           [1.0 - radius["large_share"], radius["large_share"]]),
                    "discrete": lambda: (radius["radii"], radius["shares"])}[kind]()
        r, passing = np.repeat(r, 2), np.repeat(np.cumsum([0.0, *share]), 2)[1:-1]
    elif kind == "grading":
        r, passing = graded(radius)
    else:
        r = np.geomspace(radius["min"], radius["max"], 2001)
        passing = {"uniform": lambda: r,
                   "gaussian": lambda: normal((r - radius["mean"]) / radius["sd"]),
                   "lognormal": lambda: normal(np.log(r / radius["median"]) / radius["log_sd"]),
                   "weibull": lambda: -np.exp(-(r / radius["scale"]) ** radius["shape"])}[kind]()
    passing = (passing - passing[0]) / (passing[-1] - passing[0])
    low, high = r[:-1], r[1:]
    cube = (low + high) * (low ** 2 + high ** 2) / 4.0   # the mean of r^3 between two radii
    own = np.diff(passing)
    other = np.append(0.0, np.cumsum(own / cube if by_mass else own * cube))
    other /= other[-1]
    return (r, other, passing) if by_mass else (r, passing, other)


def normal(x):
    from math import erf
    return np.array([0.5 * (1.0 + erf(value / 2.0 ** 0.5)) for value in x])


def graded(radius):
    """The part of a grading curve that is kept, with points between the sieves."""
    curve = np.array(radius["diameter_curve"], dtype=float)
    logarithmic = radius.get("interpolation", "log") == "log"
    place = np.log(curve[:, 0]) if logarithmic else curve[:, 0]
    low, high = radius.get("keep_percent", [0.0, 100.0])
    percent = np.unique(np.concatenate([np.linspace(low, high, 2001), curve[:, 1].clip(low, high)]))
    x = np.interp(percent, curve[:, 1], place)
    return 0.5 * (np.exp(x) if logarithmic else x), percent


def achieved_curve(values):
    """The radii [m] of a pack, ascending, and the shares of number and mass up to each."""
    r = np.sort(values)
    mass = np.cumsum(r ** 3)
    return r, np.arange(1, len(r) + 1) / len(r), mass / mass[-1]
