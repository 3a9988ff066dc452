"""A pack and what stands beside it: the file NAME.hdf, its time series, its analysis by `packmpi analyze`."""
import csv
import json
import math
import shutil
import subprocess
import tomllib
from pathlib import Path
from typing import Any, Union

import h5py
import numpy as np
from numpy.typing import NDArray

from .problem import Problem

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


def plain(value: Any) -> Any:
    """An attribute as Python has it: texts come as str or as bytes, depending on the version of h5py."""
    if isinstance(value, bytes):
        return value.decode(errors="replace")
    return value.tolist() if isinstance(value, (np.generic, np.ndarray)) else value


# What packs of format version 1 call otherwise; there, target_... and achieved_... are ..._asked and ..._got.
FORMER = {"creep": "compaction_rate", "thaws": "relaxations", "thaw_steps": "relaxation_steps",
          "height_before_thaw": "height_before_relaxation", "thaw": "relaxation"}


def present(name: str) -> str:
    """The name of today of what a former format version calls `name`."""
    for ending, beginning in (("_asked", "target_"), ("_got", "achieved_")):
        if name.endswith(ending):
            return beginning + name.removesuffix(ending)
    return FORMER.get(name, name)


def attributes(group: h5py.Group) -> dict[str, Any]:
    """All attributes of a group, by the names of today."""
    return {present(name): plain(value) for name, value in group.attrs.items()}


def arrays(group: h5py.Group) -> dict[str, NDArray[Any]]:
    """All datasets of a group, by name."""
    return {name: data[:] for name, data in group.items()}


class Pack:
    """A pack in memory; doc/file_format.md names every number. N particles, M contacts, SI units.

    path            the file
    dimension       2 or 3
    size            (dimension): lateral extents, then the target height H_d [m]
    position        (N, 3): centres [m]; in 2D z is 0 and y is upward
    radius          (N) [m]
    velocity        (N, 3) [m/s]
    spin            (N, 3) [rad/s], or None without rotation; in 2D only z is not zero
    layer           (N): layer of insertion, from 0
    contacts        (N): touching particles
    pairs, forces   (M, 2) ids and (M, 3) forces on the first [N], or None if the pack was written without contacts
    pair_contacts, wall_contacts    all that the pack has of contacts, by name: pair or particle and wall, overlap, normal, force, and the
                    displacements that they remember; empty dictionaries without contacts, or of a pack that was made before there were any
    phi, phi_bulk   solid fraction below H_d, and of the bulk: between 0.2 and 0.8 of H_d, or of the height of a bed below that
    porosity_bulk, void_ratio_bulk    1 - phi_bulk, (1 - phi_bulk) / phi_bulk; infinite where there is nothing
    summary, audit, rest, layers, provenance    what the file says of the whole pack, by name; layers: a list for each name; rest:
                    measures, their limits (NAME_limit) and what was missed; empty of a pack that was made before there was rest

    Raises Problem if the file cannot be read or is no pack. The seal is not looked at: `packmpi info` does that.
    """

    def __init__(self, path: Union[str, Path]) -> None:
        self.path = Path(path)
        try:
            with h5py.File(path, "r") as file:
                if plain(file.attrs.get("format")) != "packmpi-pack":
                    raise Problem(f"{path} is not a pack of packmpi (root attribute 'format')")
                self._read(file)
        except OSError as error:
            raise Problem(f"cannot read {path}: {error}") from error
        except KeyError as error:
            raise Problem(f"{path} is incomplete: {error}") from error

    def _read(self, file: h5py.File) -> None:
        particles = file["particles"]
        self.position: Floats = particles["position"][:]
        self.radius: Floats = particles["radius"][:]
        self.velocity: Floats = particles["velocity"][:]
        self.spin: Union[Floats, None] = particles["spin"][:] if "spin" in particles else None
        self.layer: Integers = particles["layer"][:]
        self.contacts: Integers = particles["contacts"][:]
        self.summary = attributes(file["summary"])
        self.audit = attributes(file["summary/audit"])
        self.rest = attributes(file["summary/rest"]) if "summary/rest" in file else {}
        self.layers: dict[str, list[Any]] = {present(name): data[:].tolist() for name, data in file["summary/layers"].items()}
        self.provenance = attributes(file["provenance"])
        self.size: Floats = np.array(self.summary["size"], dtype=float)
        self.dimension: int = self.summary["dimension"]
        self.phi: float = self.summary["phi"]
        self.phi_bulk: float = self.summary["phi_bulk"]
        self.porosity_bulk: float = 1.0 - self.phi_bulk
        self.void_ratio_bulk: float = self.porosity_bulk / self.phi_bulk if self.phi_bulk else math.inf
        self.pair_contacts = arrays(file["contacts"]) if "contacts" in file else {}
        self.wall_contacts = arrays(file["wall_contacts"]) if "wall_contacts" in file else {}
        has_contacts = "contacts" in file
        self.pairs: Union[Integers, None] = file["contacts/pair"][:] if has_contacts else None
        self.forces: Union[Floats, None] = file["contacts/force"][:] if has_contacts else None

    @property
    def count(self) -> int:
        """N, the number of particles."""
        return len(self.radius)

    @property
    def noun(self) -> str:
        """What the particles are called."""
        return "spheres" if self.dimension == 3 else "discs"

    @property
    def name(self) -> str:
        """Stem of the file's name."""
        return self.path.stem

    @property
    def speed(self) -> Floats:
        """(N): magnitude of the velocity [m/s]."""
        return np.linalg.norm(self.velocity, axis=1)

    def top(self) -> float:
        """Highest particle top, at least the target height [m]."""
        vertical = self.dimension - 1
        highest = float((self.position[:, vertical] + self.radius).max()) if self.count else 0.0
        return max(highest, float(self.size[vertical]))

    def scene(self) -> dict[str, Any]:
        """The scene with every default, in SI units, as tables of tables, by the names of today."""
        scene = tomllib.loads(self.provenance["effective_input"])
        return {**scene, "dynamics": {present(name): value for name, value in scene.get("dynamics", {}).items()}}

    def steps(self) -> dict[str, Floats]:
        """The time series NAME.steps.csv, a column for each name (without its unit); empty if it is not beside the pack."""
        try:
            with open(self.path.with_suffix(".steps.csv"), newline="", encoding="utf-8") as file:
                rows = list(csv.reader(file))
        except OSError:
            return {}
        columns = np.array(rows[1:], dtype=float).T
        return {name.split(" [")[0]: column for name, column in zip(rows[0], columns)} if len(rows) > 1 else {}

    def analysis(self, program: Union[str, Path, None] = None) -> dict[str, Any]:
        """What `packmpi analyze` says of the pack (doc/analyze.md).

        The program is run unless NAME.analysis.json is there and newer than pack and program. `program`: its path; None: the
        one of this tree, or of PATH. Raises Problem if there is none, or if it fails.
        """
        found = self.path.with_suffix(".analysis.json")
        program = program or program_here()
        newest = max(Path(one).stat().st_mtime for one in (self.path, program) if one)
        if not found.exists() or found.stat().st_mtime < newest:
            if program is None:
                raise Problem(f"{found} is missing, and there is no packmpi to make it: put it into PATH, or name it by --program")
            done = subprocess.run([str(program), "analyze", str(self.path)], text=True, stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, check=False)
            if done.returncode != 0:
                raise Problem(f"packmpi analyze {self.path} ended with code {done.returncode}:\n{done.stdout}")
        return json.loads(found.read_text(encoding="utf-8"))


def program_here() -> Union[str, None]:
    """The program that was built in this tree, else the one that is installed, else None."""
    built = Path(__file__).resolve().parents[3] / "build" / "packmpi"
    return str(built) if built.exists() else shutil.which("packmpi")
