"""Dense random packs of spheres for DEM: make them, read them, draw them, hand them over.

>>> import packmpi
>>> pack = packmpi.run("input/quickstart.toml")
>>> pack.position.shape, pack.radius.mean(), pack.phi_bulk
>>> pack.save("quickstart.hdf"); pack.convert("lammps")

    scene(source)      a scene from a file, a dictionary or a text: check(), estimate()
    run(scene)         its pack
    ensemble(scene)    its packs
    read(file)         a pack that was made before
    Pack               arrays, and analyze(), convert(), report(), save()
    Problem, SceneError    what went wrong; a SceneError has file, line and key

All numbers are in SI units. It works in plain Python, on one rank; under `mpirun -n N python3`, on all of them; and with a
communicator of mpi4py, on its ranks. MPI starts when it is first needed: importing and reading start none. doc/python.md tells more.
"""
from pathlib import Path
from typing import Union

from .making import Ensemble, Progress, ensemble, run
from .pack import Pack
from .problem import Problem, SceneError
from .scenes import Scene, scene

__all__ = ["Ensemble", "Pack", "Problem", "Progress", "Scene", "SceneError", "ensemble", "read", "run", "scene"]


def read(file: Union[str, Path]) -> Pack:
    """A pack that was made before, NAME.hdf: the same as Pack(file). Raises Problem."""
    return Pack(file)
