"""The compiled part, started when it is first needed: MPI and PETSc run from then on to the end of the process."""
import atexit
from functools import lru_cache
from types import ModuleType
from typing import TYPE_CHECKING, Any, Optional

from .problem import Problem


@lru_cache(maxsize=None)
def loaded() -> ModuleType:
    """packmpi._core. Raises Problem, with what to do, if it was not built for this Python."""
    try:
        from . import _core
    except ImportError as error:
        raise Problem("this packmpi reads and draws packs, but cannot make them: its compiled part is missing for this Python "
                      f"({error}). scripts/build.sh makes it in build/python, for Debian's /usr/bin/python3") from error
    atexit.register(_core.end)   # before MPI is ended, by us or by mpi4py
    return _core


class _Core:
    """packmpi._core, loaded when something of it is asked for."""

    def __getattr__(self, name: str) -> Any:
        return getattr(loaded(), name)


if TYPE_CHECKING:   # so that every call is held against _core.pyi
    from . import _core
    core = _core
else:
    core = _Core()


def number_of(comm: Optional[Any]) -> Optional[int]:
    """A communicator of mpi4py as a number for the compiled part; None: all ranks."""
    if comm is None:
        return None
    if not hasattr(comm, "py2f"):
        raise Problem(f"comm is a {type(comm).__name__}; give a communicator of mpi4py, or None for all ranks")
    return int(comm.py2f())
