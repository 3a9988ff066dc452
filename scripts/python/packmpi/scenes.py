"""Scenes: what is to be packed, and what will come of it."""
import json
import tomllib
from os import PathLike, fspath
from typing import Any, Mapping, Optional, Sequence, Union

from .core import core, number_of
from .problem import SceneError
from .toml import dumps, scalar

Source = Union[str, "PathLike[str]", Mapping[str, Any]]


class Scene:
    """A scene that was read and found valid (doc/input.md). It never changes; `packmpi.scene(...)` makes one.

    name         NAME of the files it becomes
    file         its path, as it was given
    text         the scene with every default, TOML: a scene file itself
    dimension    2 or 3
    packs        packs of its [ensemble]; 1: none
    remarks      what was taken how, sentences
    """

    def __init__(self, made: Any) -> None:
        self.made = made
        self.name: str = made.name
        self.file: str = made.file
        self.text: str = made.effective
        self.dimension: int = made.dimension
        self.packs: int = made.packs
        self.remarks: list[str] = made.remarks

    def __repr__(self) -> str:
        return f"<packmpi scene {self.name}, {self.dimension}D>"

    def keys(self) -> dict[str, Any]:
        """The scene with every default, in SI units, as tables of tables."""
        return tomllib.loads(self.text)

    def check(self, comm: Optional[Any] = None) -> dict[str, Any]:
        """What follows from the scene; nothing is run. Collective over `comm`.

        particles (about), time_step and time_step_limit [s], most_ranks, mean_overlap [radii, at rest], restitution, remarks and
        warnings (lists of sentences). Raises SceneError.
        """
        return json.loads(core.check(self.made, number_of(comm)))

    def estimate(self, *, particles: int = 0, height: float = 0.0, floor: Sequence[Optional[float]] = (), ranks: int = 0, probe: bool = True,
                 comm: Optional[Any] = None) -> dict[str, Any]:
        """What the scene will take, as `packmpi estimate --json` tells it (doc/estimate.md). Collective over `comm`.

        particles    ask for so many: the height is found, or with `height` the floor
        height       ask for this target height [m]
        floor        ask for these sides [m]; None: this one is open
        ranks        MPI ranks to think of; 0: those of comm
        probe        try how fast this machine is, for a second or two: without it there is no time

        Raises SceneError.
        """
        return json.loads(core.estimate(self.made, number_of(comm), particles, height, list(floor), ranks, probe))


def scene(source: Source, *, set: Optional[Mapping[str, Any]] = None, seed: Optional[int] = None,   # pylint: disable=redefined-builtin
          name: str = "scene") -> Scene:
    """Reads a scene. Local: every rank reads for itself.

    source    a path; or a dictionary of tables, {"container": {"size": [0.6, 0.6, 0.45]}, ...}; or the text of a scene (with line ends)
    set       changes, {"layers.duration": 0.5}
    seed      another seed
    name      of the files that a dictionary or a text becomes; its lines are told as of NAME.toml, and a curve that it names is looked
              for in the working folder

    Numbers are in SI units; a text with a unit, "20 mm", does as well. Raises SceneError with file, line and key.
    """
    if not name or "/" in name:
        error = SceneError(f"name: {name!r} is no name of files; give a word, and folder= where they are to be")
        error.code, error.key = 2, "name"
        raise error
    changes = [f"{key}={scalar(value, key)}" for key, value in (set or {}).items()]
    if seed is not None:
        changes.append(f"seed={int(seed)}")
    if isinstance(source, Mapping):
        return Scene(core.Scene.from_text(dumps(source), f"{name}.toml", changes))
    path = fspath(source)
    if "\n" in path:
        return Scene(core.Scene.from_text(path, f"{name}.toml", changes))
    return Scene(core.Scene.from_file(path, changes))
