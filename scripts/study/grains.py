"""Measures of a pack of spheres in numpy alone, the same for every code's packs: contacts, cores of the contact graph, solid fraction.

A container is `size` (x, y, height asked, m), a floor at z = 0, and lateral axes that are periodic or end in planes at 0 and size.
"""
import numpy as np
from scipy.spatial import cKDTree


def wrapped(positions, size, periodic):
    """Positions with the periodic coordinates in [0, size)."""
    out = np.array(positions, float)
    for axis in range(2):
        if periodic[axis]:
            out[:, axis] %= size[axis]
            out[out[:, axis] >= size[axis], axis] = 0.0
    return out


def contacts(positions, radii, size, periodic):
    """Pairs (M, 2) that overlap and their overlaps [m]."""
    inside = wrapped(positions, size, periodic)
    box = [size[axis] if periodic[axis] else 0.0 for axis in range(2)] + [0.0]   # 0: not periodic
    pairs = cKDTree(inside, boxsize=box).query_pairs(2.0 * radii.max(), output_type="ndarray")
    apart = inside[pairs[:, 0]] - inside[pairs[:, 1]]
    for axis in range(2):
        if periodic[axis]:
            apart[:, axis] -= size[axis] * np.round(apart[:, axis] / size[axis])
    overlap = radii[pairs].sum(axis=1) - np.linalg.norm(apart, axis=1)
    return pairs[overlap > 0.0], overlap[overlap > 0.0]


def wall_contacts(positions, radii, size, periodic):
    """How many walls each sphere touches, the floor among them."""
    touching = (positions[:, 2] < radii).astype(int)
    for axis in range(2):
        if not periodic[axis]:
            touching += (positions[:, axis] < radii).astype(int) + (positions[:, axis] > size[axis] - radii).astype(int)
    return touching


def core(pairs, walls, least):
    """The spheres that keep at least `least` contacts, walls counted, when those that do not are taken away, again and again."""
    held = np.ones(len(walls), bool)
    while True:
        alive = held[pairs].all(axis=1)
        degree = np.bincount(pairs[alive].ravel(), minlength=len(walls)) + walls
        fresh = held & (degree >= least)
        if fresh.sum() == held.sum():
            return held
        held = fresh


def solid_between(low, high, heights, radii):
    """Volume of spheres between two levels, with exact caps [m3]."""
    def below(level):
        h = np.clip(level - heights + radii, 0.0, 2.0 * radii)
        return np.sum(np.pi * h * h * (3.0 * radii - h) / 3.0)
    return float(below(high) - below(low))


def measures(positions, radii, size, periodic):
    """phi_bulk (0.2 to 0.8 of the height asked), mean contacts with other spheres of all spheres and of those with their centre in the bulk,
    the same among the spheres that are no rattlers (core of dimension + 1 contacts; `core_3`, `core_2`: of 3 and 2), shares of rattlers,
    mean overlap over the smaller radius."""
    pairs, overlap = contacts(positions, radii, size, periodic)
    walls = wall_contacts(positions, radii, size, periodic)
    height = positions[:, 2] / size[2]
    bulk = (height > 0.2) & (height < 0.8)
    touching = np.bincount(pairs.ravel(), minlength=len(radii))
    out = {"spheres": len(radii), "phi_bulk": solid_between(0.2 * size[2], 0.8 * size[2], positions[:, 2], radii) / (0.6 * np.prod(size)),
           "coordination": touching.mean(), "coordination_bulk": touching[bulk].mean(),
           "overlap": (overlap / radii[pairs].min(axis=1)).mean(), "top": (positions[:, 2] + radii).max()}
    for least in (4, 3, 2):
        held = core(pairs, walls, least)
        inner = np.bincount(pairs[held[pairs].all(axis=1)].ravel(), minlength=len(radii))
        out |= {f"core_{least}": inner[held & bulk].mean() if (held & bulk).any() else 0.0, f"outside_{least}": 1.0 - held[bulk].mean()}
    return {name: value if isinstance(value, int) else float(value) for name, value in out.items()}
