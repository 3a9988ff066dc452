"""A pack, in memory or from its file, and what stands beside the file NAME.hdf: its time series, its analysis."""
import csv
import json
import math
import shutil
import subprocess
import tempfile
import tomllib
import weakref
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional, Sequence, Union

import numpy as np
from numpy.typing import NDArray

from .core import core, number_of
from .problem import Problem

if TYPE_CHECKING:   # it takes a third of a second, and packs in memory do not need it
    import h5py
    from ._core import Converted as CoreConverted

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


def attributes(group: "h5py.Group") -> dict[str, Any]:
    """All attributes of a group, by the names of today."""
    return {present(name): plain(value) for name, value in group.attrs.items()}


def arrays(group: "h5py.Group") -> dict[str, NDArray[Any]]:
    """All datasets of a group, by name."""
    return {name: data[:] for name, data in group.items()}


class Converted(list[Path]):
    """The files that were written.

    particles      in them
    volume         of these as spheres [m3]
    cut            what was cut out, in words; "": nothing
    cut_fraction   solid fraction of what was cut out, spheres cut by its sides; 0 if nothing was
    springs        what became of the springs of friction, in words; "": nothing to tell
    """

    def __init__(self, done: "CoreConverted") -> None:
        super().__init__(Path(file) for file in done.files)
        self.particles, self.volume = done.particles, done.volume
        self.cut, self.cut_fraction, self.springs = done.cut, done.cut_fraction, done.springs


class Pack:
    """A pack; doc/file_format.md names every number. N particles, M contacts, SI units.

    Of a file: everything, as arrays of its own. Made by packmpi.run(): this rank's share, the particles of its columns, or what was
    gathered; then arrays are read-only views of the memory that the run has left, which is not copied.

    path            the file; None: the pack is in memory only, save() writes it
    id              (N): ascending; over all ranks 0 ..
    dimension       2 or 3
    size            (dimension): lateral extents (under stress: where the sides have come to), then the target height H_d [m]
    lid             height of the lid [m], or None: the pack has a free surface
    shape           of the container: "box", or a round vessel, whose largest diameter the lateral extents are: "cylinder", "frustum", "sphere",
                    "annulus"; summary has bottom_diameter and top_diameter, or inner_diameter [m]; in 2D "circle",
                    "trapezium" (bottom_width and top_width), "polygon"
    position        (N, 3): centres [m]; in 2D z is 0 and y is upward
    radius          (N) [m]
    velocity        (N, 3) [m/s]
    spin            (N, 3) [rad/s], or None without rotation; in 2D only z is not zero
    layer           (N): layer of insertion, from 0
    contacts        (N): touching particles
    component       (N): number of the component, from 0; zeros with one
    components      names of the components; empty with one
    pairs, forces   (M, 2) ids and (M, 3) forces on the first [N], or None if the pack was written without contacts
    pair_contacts, wall_contacts    all that the pack has of contacts, by name: pair or particle and wall, overlap, normal, force, and the
                    displacements that they remember; empty dictionaries without contacts, or of a pack that was made before there were any.
                    In memory each contact is on one rank, where its first particle is
    phi, phi_bulk   solid fraction below H_d, and of the bulk: between 0.2 and 0.8 of H_d, or of the height of a bed below that
    porosity_bulk, void_ratio_bulk    1 - phi_bulk, (1 - phi_bulk) / phi_bulk; infinite where there is nothing
    summary, audit, rest, layers, provenance    what the file says of the whole pack, by name; layers: a list for each name; rest:
                    measures, their limits (NAME_limit) and what was missed; empty of a pack that was made before there was rest
    missed          targets that were missed, a sentence each; empty: none

    Numbers of the whole pack are the same on every rank. Raises Problem if the file cannot be read or is no pack. The seal is not looked at: `packmpi info` does that.
    """

    def __init__(self, path: Union[str, Path]) -> None:
        import h5py
        self.path: Optional[Path] = Path(path)
        self._begin(self.path.stem)
        try:
            with h5py.File(path, "r") as file:
                if plain(file.attrs.get("format")) != "packmpi-pack":
                    raise Problem(f"{path} is not a pack of packmpi (root attribute 'format')")
                self._read(file)
        except OSError as error:
            raise Problem(f"cannot read {path}: {error}") from error
        except KeyError as error:
            raise Problem(f"{path} is incomplete: {error}") from error

    def _begin(self, name: str) -> None:
        self._name = name
        self._made: Any = None                                       # of packmpi.run(): packmpi._core.Packing
        self._comm: Any = None                                       # of those ranks that have it
        self._folder: Optional[str] = None                           # of a file that nobody asked for

    @classmethod
    def made(cls, made: Any, comm: Any, path: Optional[Path], name: str) -> "Pack":
        """What packmpi.run() returns: views of the memory of `made`."""
        pack = cls.__new__(cls)
        pack._begin(name)
        pack._made, pack._comm, pack.path = made, comm, path
        pack.id, pack.position, pack.radius, pack.velocity = made.id, made.position, made.radius, made.velocity
        pack.spin, pack.layer, pack.contacts = made.spin, made.layer, made.contacts
        pack.pair_contacts, pack.wall_contacts = made.pair_contacts, made.wall_contacts
        pack.pairs, pack.forces = pack.pair_contacts["pair"], pack.pair_contacts["force"]
        summary = json.loads(made.summary)
        told = {**summary["target"], **summary["achieved"]}
        pack._tell({name: math.inf if value is None else value for name, value in told.items()}, summary["audit"], summary["provenance"])
        if pack.components:
            pack.component = made.component
        pack.rest = {name: one["value"] for name, one in summary["rest"].items()}
        pack.rest |= {f"{name}_limit": math.inf if one["limit"] is None else one["limit"] for name, one in summary["rest"].items()}
        pack.rest["missed"] = "\n".join(summary["missed"])
        rows = summary["layers"]
        pack.layers = {name: [row[name] for row in rows] for name in (rows[0] if rows else ()) if name != "layer"}
        return pack

    def _tell(self, summary: dict[str, Any], audit: dict[str, Any], provenance: dict[str, Any]) -> None:
        self.summary, self.audit, self.provenance = summary, audit, provenance
        scene = provenance.get("effective_input", "")
        components = tomllib.loads(scene).get("component", []) if "[[component]]" in scene else []
        self.components: list[str] = [one["name"] for one in components]
        self.component: Integers = np.zeros_like(self.layer)
        self.size: Floats = np.array(summary["size"], dtype=float)
        self.lid: Optional[float] = summary.get("lid")
        if self.lid is not None:
            sides = [summary["length_under_lid_x"], summary["length_under_lid_y"]]
            self.size[:-1] = sides[:len(self.size) - 1]
        self.shape: str = summary.get("shape", "box")
        self.dimension: int = summary["dimension"]
        self.phi: float = summary["phi"]
        self.phi_bulk: float = summary["phi_bulk"]
        self.porosity_bulk: float = 1.0 - self.phi_bulk
        self.void_ratio_bulk: float = self.porosity_bulk / self.phi_bulk if self.phi_bulk else math.inf

    def _read(self, file: "h5py.File") -> None:
        particles = file["particles"]
        self.position: Floats = particles["position"][:]
        self.radius: Floats = particles["radius"][:]
        self.id: Integers = particles["id"][:] if "id" in particles else np.arange(len(self.radius))
        self.velocity: Floats = particles["velocity"][:]
        self.spin: Union[Floats, None] = particles["spin"][:] if "spin" in particles else None
        self.layer: Integers = particles["layer"][:]
        self.contacts: Integers = particles["contacts"][:]
        self._tell(attributes(file["summary"]), attributes(file["summary/audit"]), attributes(file["provenance"]))
        if "component" in particles:
            self.component = particles["component"][:]
        self.rest = attributes(file["summary/rest"]) if "summary/rest" in file else {}
        self.layers: dict[str, list[Any]] = {present(name): [plain(value) for value in data[:].tolist()]
                                             for name, data in file["summary/layers"].items()}
        self.pair_contacts = arrays(file["contacts"]) if "contacts" in file else {}
        self.wall_contacts = arrays(file["wall_contacts"]) if "wall_contacts" in file else {}
        has_contacts = "contacts" in file
        self.pairs: Union[Integers, None] = file["contacts/pair"][:] if has_contacts else None
        self.forces: Union[Floats, None] = file["contacts/force"][:] if has_contacts else None

    def __repr__(self) -> str:
        where = self.path or "in memory"
        return f"<packmpi pack {self.name}: {self.count} {self.noun} of {self.summary.get('particles', self.count)}, {where}>"

    @property
    def missed(self) -> list[str]:
        """Targets that were missed, a sentence each."""
        return str(self.rest.get("missed", "")).splitlines()

    def gathered(self) -> "Pack":
        """All particles on rank 0 of the run's communicator, sorted by id, and none on the others. Collective. A pack of a file, which
        has everything, is returned as it is."""
        if self._made is None:
            return self
        return Pack.made(self._made.gathered(number_of(self._comm)), self._comm, self.path, self.name)

    def save(self, path: Union[str, Path], *, force: bool = False) -> Path:
        """Writes the pack file, as the program does, whole or not at all; contacts are in it if the scene says output.contacts = true.
        Collective. Raises Problem if it exists and `force` is not set, or cannot be written. A pack of a file is copied."""
        path = Path(path)
        if self._made is not None:
            self._made.write(number_of(self._comm), str(path), force)
            self.path, self._name = path, path.stem
        elif self.path is not None:
            if path.exists() and not force:
                raise Problem(f"{path} exists; say force=True, or take another name")
            shutil.copyfile(self.path, path)
        return path

    def _file(self) -> Path:
        """The pack's file; of a pack in memory one is written to a folder that goes with the pack. Collective. On several ranks there
        may be no folder that all of them see: then nobody guesses."""
        if self.path is not None:
            return self.path
        if core.ranks(number_of(self._comm)) > 1:
            raise Problem("this pack is in memory only, on several ranks: save() it to a file first, where all ranks can read it")
        if self._folder is None:
            self._folder = tempfile.mkdtemp(prefix="packmpi-")
            weakref.finalize(self, shutil.rmtree, self._folder, ignore_errors=True)
        path = Path(self._folder) / f"{self.name}.hdf"
        if not path.exists():
            self._made.write(number_of(self._comm), str(path), False)
        return path

    def analyze(self) -> dict[str, Any]:
        """What the pack is like inside: profiles, contacts, forces, g(r), order (doc/analyze.md). Collective over the ranks that have
        it. Writes NAME.analysis.json beside the pack's file; a pack in memory writes both to a folder of its own. Raises Problem."""
        path = self._file()
        core.analyze(number_of(self._comm), str(path))
        return json.loads(path.with_suffix(".analysis.json").read_text(encoding="utf-8"))

    def convert(self, format: str, file: Union[str, Path, None] = None, *, trim: str = "none", cut: str = "",   # pylint: disable=redefined-builtin
                copies: Sequence[int] = (1, 1), force: bool = False) -> Converted:
        """Writes the pack for another code (doc/convert.md). Collective. Returns the list of files, with what there is to tell of them.

        format    "lammps", "liggghts", "yade", "csv", ...: `packmpi convert --help` lists them
        file      to write; None: beside the pack's file, with the format's ending. Give it for a pack in memory
        trim      "drop" leaves out what reaches above the target height, "cut" what has its centre there
        cut       takes a specimen out: "cylinder:diameter=0.15,height=0.3", a box, a sphere, or a closed surface, "part.stl:unit=mm"
                  (doc/vessels.md): particles wholly inside are kept
        copies    so many side by side along x and y, periodic axes only
        force     files that exist may be replaced

        Raises Problem.
        """
        if file is None and self.path is None:
            raise Problem("this pack is in memory only: give the file to write, or save() it first")
        return Converted(core.convert(number_of(self._comm), str(self._file()), format, "" if file is None else str(file), trim, cut,
                                      list(copies), force))

    def report(self, file: Union[str, Path, None] = None, *, size: int = 700, crate: str = "") -> Path:
        """Writes one page on the pack, HTML, with pictures and plots inside (doc/analyze.md). Collective; rank 0 writes it. Needs
        matplotlib and VTK (scripts/setup.sh --render). `file`: None is beside the pack's file; give it for a pack in memory. `size`:
        width of pictures in pixels, about. `crate`: a licence, as "CC-BY-4.0": a record for an archive (RO-Crate) is written beside the
        pack's file, too (doc/specimens.md). Raises Problem."""
        if file is None and self.path is None:
            raise Problem("this pack is in memory only: give the page to write, or save() it first")
        if crate and self.path is None:
            raise Problem("this pack is in memory only: save() it first, the record for an archive stands beside it")
        path = self._file()
        self.analyze()
        page = Path(file) if file is not None else path.with_suffix(".html")
        if core.rank(number_of(self._comm)) == 0:
            try:
                from .report import write_page
            except ImportError as error:
                from .__main__ import missing
                raise Problem(missing(error)) from error
            write_page(Pack(path), page, pixels=size)
            if crate:
                from .crate import write_record
                write_record(Pack(path), crate)
        return page

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
        """Stem of the file's name; of a pack in memory the scene's name."""
        return self._name

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
        if self.path is None:
            return {}
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
        one of this tree, or of PATH. Raises Problem if there is none, or if it fails. In a process that has made packs: analyze().
        """
        if self.path is None:
            return self.analyze()
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
