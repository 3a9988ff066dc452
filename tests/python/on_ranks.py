"""On all ranks of mpirun, in the folder where the program has made bed.hdf of bed.toml: shares, gathered, on a part of the ranks."""
import tomllib
from pathlib import Path

import numpy as np

import packmpi
from packmpi.core import core

try:
    from mpi4py import MPI
except ImportError:
    MPI = None

NAMES = ("id", "position", "radius", "velocity", "spin", "layer", "contacts", "component")


def expect_same(pack, other):
    for name in NAMES:
        np.testing.assert_array_equal(getattr(pack, name), getattr(other, name), name)
    for ours, theirs in ((pack.pair_contacts, other.pair_contacts), (pack.wall_contacts, other.wall_contacts)):
        for name in ours:
            np.testing.assert_array_equal(ours[name], theirs[name], name)
    assert pack.phi_bulk == other.phi_bulk and pack.layers == other.layers and pack.missed == other.missed


def failing(action):
    """The Problem that an action raises."""
    try:
        action()
    except packmpi.Problem as error:
        return error
    raise AssertionError("nothing was raised")


def on_a_part(rank, ranks, made):
    """The others make something else meanwhile."""
    part = MPI.COMM_WORLD.Split(0 if rank == ranks - 1 else 1)
    alone = packmpi.run("bed.toml", part, gather=True)
    if part.rank == 0:
        expect_same(alone, made)
    other = packmpi.run(packmpi.scene("bed.toml", seed=10 + (rank == ranks - 1)), part)
    assert other.provenance["ranks"] == part.size
    part.Free()


def of_components(rank):
    """A mixture in memory has the component of each particle, as its file has."""
    keys = tomllib.loads(Path("bed.toml").read_text()) | {"mixture": {"share_by": "mass"}, "component": [
        {"name": "heavy", "share": 1.0, "density": 3000.0, "radius": {"distribution": "equal", "value": 0.012}},
        {"name": "light", "share": 2.0}]}
    two = packmpi.scene(keys, name="two")
    share = packmpi.run(two)
    assert share.components == ["heavy", "light"] and len(share.component) == share.count
    np.testing.assert_array_equal(share.component == 0, share.radius == 0.012)
    whole = share.gathered()
    share.save("two.hdf", force=True)
    filed = packmpi.read("two.hdf")
    if rank == 0:
        expect_same(whole, filed)
    assert filed.components == share.components and 0 < filed.component.sum() < filed.count


def main():
    rank, ranks = core.rank(None), core.ranks(None)
    made = packmpi.read("bed.hdf")
    share = packmpi.run("bed.toml")
    assert share.summary["particles"] == made.count and (ranks == 1 or share.count < made.count)
    assert np.all(np.diff(share.id) > 0)
    expected = made.position[share.id]
    np.testing.assert_array_equal(share.position, expected)
    whole = share.gathered()
    if rank == 0:
        expect_same(whole, made)
    assert whole.count == (made.count if rank == 0 else 0)

    share.save(f"saved_{ranks}.hdf", force=True)
    expect_same(packmpi.read(f"saved_{ranks}.hdf"), made)
    assert share.analyze()["contacts"]["rattlers"] >= 0.0

    filed = packmpi.run("bed.toml", folder=f"on_{ranks}", force=True, gather=True)
    if rank == 0:
        expect_same(filed, made)
    expect_same(packmpi.read(f"on_{ranks}/bed.hdf"), made)
    assert failing(lambda: packmpi.run("bed.toml", folder=f"on_{ranks}")).code == 2   # it exists

    # Whoever raises has its own exception, the others a Problem; nobody waits for ever.
    def stop(now):
        if now.share > 0.5 and rank == ranks - 1:
            raise KeyError("enough")
    try:
        packmpi.run("bed.toml", progress=stop)
    except KeyError:
        assert rank == ranks - 1
    except packmpi.Problem as error:
        assert rank != ranks - 1 and error.code == 75
    else:
        raise AssertionError("nothing ended the run")
    assert failing(lambda: packmpi.run({"container": {"siez": [1, 1, 1]}})).key == "container.siez"
    of_components(rank)
    if MPI is not None:
        on_a_part(rank, ranks, made)
        expect_same(packmpi.run("bed.toml", MPI.COMM_SELF), made)


main()
