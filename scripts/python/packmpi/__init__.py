"""Packs of packmpi in Python: read them, draw them, plot them, report on them.

>>> from packmpi import Pack
>>> pack = Pack("quickstart.hdf")
>>> pack.position.shape, pack.phi_bulk

All numbers are in SI units. `packmpi render`, `packmpi plot` and `packmpi report` start `python3 -m packmpi`, this package's
command line. Reading needs numpy and h5py, plots matplotlib, pictures in 3D also VTK and a (virtual) X screen.
"""
from .problem import Problem
from .read import Pack

__all__ = ["Pack", "Problem"]
