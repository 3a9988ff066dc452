"""From scenes to packs."""
import json
import sys
import threading
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Callable, Iterator, NamedTuple, Optional, Union

from .core import core, number_of
from .pack import Pack
from .problem import Problem
from .scenes import Scene, Source, scene as scene_of


class Progress(NamedTuple):
    """Where a run is.

    stage        "inserting", "settling" (a layer) or "relaxing" (the final stage)
    layer        from 1
    share        of the stage that is done, 0 .. 1
    particles    inserted so far, on all ranks
    height       [m] of the bed, after the last layer that has settled
    """

    stage: str
    layer: int
    share: float
    particles: int
    height: float


def show(now: Progress) -> None:
    """A line on stderr, rewritten."""
    print(f"\rlayer {now.layer}, {now.stage} {100.0 * now.share:3.0f} %: {now.particles} particles, height {now.height:.4g} m ",
          end="", file=sys.stderr, flush=True)


def listener(progress: Union[bool, Callable[[Progress], None], None], rank: int) -> Optional[Callable[..., None]]:
    """What the compiled part calls."""
    if not progress or (progress is True and rank > 0):
        return None
    told = show if progress is True else progress
    return lambda *now: told(Progress(*now))


def ready(source: Union[Scene, Source]) -> Scene:
    """A scene, whether it was read or not."""
    return source if isinstance(source, Scene) else scene_of(source)


def run(scene: Union[Scene, Source], comm: Optional[Any] = None, *, folder: Union[str, Path, None] = None, force: bool = False,
        restart: str = "", max_hours: float = 0.0, gather: bool = False,
        progress: Union[bool, Callable[[Progress], None], None] = None) -> Pack:
    """Makes the pack of a scene. Collective over `comm`; the same bits on any number of ranks, and as the program's.

    scene        a Scene, or what packmpi.scene() takes
    comm         a communicator of mpi4py, all ranks or a part of them; None: all ranks (without mpirun: this process)
    folder       where NAME.hdf and the other outputs go (doc/file_format.md), made if missing; None: nothing is written
    force        outputs that exist may be replaced
    restart      with a folder: "auto" goes on from the newest checkpoint there, a path from that one
    max_hours    with a folder: write a checkpoint and raise Problem (code 75) before so much wall time
    gather       all particles on rank 0, sorted by id, and none on the others; else each rank has its share
    progress     called with a Progress at each row of the step log (`output.log_every`) and at the ends of layers; what it raises ends the run on all
                 ranks. True: one line on stderr, rewritten

    Returns a Pack; one that missed targets, too: Pack.missed. Raises SceneError or Problem, on all ranks. Ctrl-C ends it.
    """
    what, here = ready(scene), number_of(comm)
    told = listener(progress, core.rank(here))
    made = core.run(what.made, here, str(folder) if folder else "", force, restart, max_hours, told)
    if progress is True and told:
        print(file=sys.stderr)
    if gather:
        made = made.gathered(here)
    return Pack.made(made, comm, Path(folder) / f"{what.name}.hdf" if folder else None, what.name)


class Ensemble:
    """Packs of one scene, by seed.

    folder      where they are
    code        the worst exit code of its packs: 0, or 3 if a target was missed
    summary     what NAME.ensemble.json says (doc/ensembles.md)
    paths       of the packs that are there
    """

    def __init__(self, folder: Path, name: str, code: int) -> None:
        self.folder, self.name, self.code = folder, name, code
        self.summary: dict[str, Any] = json.loads((folder / f"{name}.ensemble.json").read_text(encoding="utf-8"))
        self.paths = sorted(folder.glob(f"{name}_*.hdf"))

    def __len__(self) -> int:
        return len(self.paths)

    def __iter__(self) -> Iterator[Pack]:
        """The packs, one after the other, read when they are asked for."""
        return (Pack(path) for path in self.paths)


def show_packs(done: int, packs: int) -> None:
    """A line on stderr, rewritten."""
    print(f"\r{done} of {packs} packs ", end="\n" if done == packs else "", file=sys.stderr, flush=True)


@contextmanager
def counted(folder: Path, what: Scene, progress: Union[bool, Callable[[int, int], None], None], fresh: bool) -> Iterator[None]:
    """Meanwhile, whoever wants to know is told how many packs there are. fresh: those that lie there already will be made anew."""
    if not progress:
        yield
        return
    told = show_packs if progress is True else progress
    old = {path: path.stat().st_mtime_ns for path in folder.glob(f"{what.name}_*.hdf")} if fresh else {}
    ended, last = threading.Event(), -1

    def tell() -> None:
        nonlocal last
        done = sum(old.get(path) != path.stat().st_mtime_ns for path in folder.glob(f"{what.name}_*.hdf"))
        if done != last:
            last = done
            told(done, what.packs)

    def watch() -> None:
        while not ended.wait(0.2):
            tell()

    tell()
    thread = threading.Thread(target=watch, daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()
    tell()


def ensemble(scene: Union[Scene, Source], folder: Union[str, Path], comm: Optional[Any] = None, *, force: bool = False,
             restart: str = "", max_hours: float = 0.0, progress: Union[bool, Callable[[int, int], None], None] = None) -> Ensemble:
    """Makes all packs of a scene with an [ensemble], and their tables (doc/ensembles.md). Collective over `comm`.

    Groups of ranks make packs side by side; each pack has the bits that it has when made alone. Parameters as of run(), but progress: called
    on rank 0, in a thread of its own, with how many packs are in the folder and how many there will be, whenever that changes; True: one
    line on stderr. It cannot end the run. Raises SceneError or Problem, on all ranks; a pack that fails does not stop the others, but is a
    Problem in the end.
    """
    what = ready(scene)
    if what.packs < 2:
        raise Problem(f'{what.file}: one pack is no ensemble; set "ensemble.packs", or call packmpi.run()')
    here = number_of(comm)
    with counted(Path(folder), what, progress if core.rank(here) == 0 else None, fresh=not restart):
        code = core.make_ensemble(what.made, here, str(folder), force, restart, max_hours)
    if code not in (0, 3):
        failed = Problem(f"{folder}: packs of the ensemble failed (code {code}); their logs say why")
        failed.code = code
        raise failed
    return Ensemble(Path(folder), what.name, code)
