#!/usr/bin/env python3
"""Draws doc/images/modules.svg: the modules of src/ in their order, and which includes which (arrows that others imply are left out)."""
import html
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]
WIDTH, HEIGHT, ACROSS, DOWN, MARGIN = 132, 44, 168, 82, 24
WORDS = {  # what a module is for, in two or three words
    "base": "types, errors, random", "comm": "MPI, exact sums", "disk": "files, HDF5, seal", "particles": "records of one rank",
    "mesh": "surfaces of triangles", "geometry": "container, columns", "document": "TOML with places", "input": "scene file to structs", "scene": "sizes, ownership", "rsa": "insertion of a layer",
    "neighbor": "ghosts, lists, frozen", "implicit": "steps by Newton", "dynamics": "law, kernel, steps", "observe": "measures, reads only", "report": "tables, JSON, series",
    "pack": "packs, checkpoints", "handover": "specimens, springs", "exporters": "other codes' formats", "forecast": "estimate, probe", "ensemble": "many packs", "tables": "units, sieve tables", "control": "friction for a density", "run": "Algorithm 1, keeper", "confine": "lid, stress, servo",
    "config": "a scene as structs", "checks": "keys against keys", "law": "contact constants", "start": "what one goes on from",
    "library": "for other programs", "cli": "command line", "python": "for Python"}


def includes(modules: list[str]) -> dict[str, set[str]]:
    """For each module the others that its files include."""
    used: dict[str, set[str]] = {module: set() for module in modules}
    for module in modules:
        for file in sorted((ROOT / "src" / module).glob("*.[hc]pp")):
            used[module] |= set(re.findall(r'^#include "([a-z]+)/', file.read_text(), re.MULTILINE)) & set(modules)
        used[module].discard(module)
    return used


def reduced(used: dict[str, set[str]]) -> dict[str, set[str]]:
    """Without the arrows that follow from others."""
    def reach(module: str) -> set[str]:
        return used[module].union(*(reach(other) for other in used[module])) if used[module] else set()
    return {module: {other for other in others if not any(other in reach(third) for third in others - {other})}
            for module, others in used.items()}


def svg(modules: list[str]) -> str:
    used = reduced(includes(modules))
    floor: dict[str, int] = {}
    for module in modules:  # in their order, so what it includes has its floor already
        floor[module] = 1 + max((floor[other] for other in used[module]), default=-1)
    rows = [[m for m in modules if floor[m] == f] for f in range(max(floor.values()) + 1)]
    wide = max(len(row) for row in rows) * ACROSS
    place = {m: (MARGIN + wide / 2 + (k - (len(row) - 1) / 2) * ACROSS, MARGIN + HEIGHT / 2 + (len(rows) - 1 - f) * DOWN)
             for f, row in enumerate(rows) for k, m in enumerate(row)}
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide + 2 * MARGIN} {len(rows) * DOWN + MARGIN}" font-family="sans-serif">',
           f'<rect width="{wide + 2 * MARGIN}" height="{len(rows) * DOWN + MARGIN}" fill="#ffffff"/>',
           '<defs><marker id="a" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
           '<path d="M0 0L8 4L0 8z" fill="#667"/></marker></defs>']
    for module, others in used.items():
        for other in sorted(others):
            (x, y), (u, v) = place[module], place[other]
            out.append(f'<path d="M{x:.0f} {y + HEIGHT / 2:.0f}C{x:.0f} {y + DOWN / 2 + 8:.0f} {u:.0f} {v - DOWN / 2 - 8:.0f} {u:.0f} {v - HEIGHT / 2:.0f}" '
                       'fill="none" stroke="#99a" marker-end="url(#a)"/>')
    for module, (x, y) in place.items():
        out.append(f'<rect x="{x - WIDTH / 2:.0f}" y="{y - HEIGHT / 2:.0f}" width="{WIDTH}" height="{HEIGHT}" rx="5" fill="#eef3fa" stroke="#447"/>'
                   f'<text x="{x:.0f}" y="{y - 2:.0f}" text-anchor="middle" font-size="15" font-weight="bold" fill="#223">{module}</text>'
                   f'<text x="{x:.0f}" y="{y + 14:.0f}" text-anchor="middle" font-size="10.5" fill="#445">{html.escape(WORDS[module])}</text>')
    return "\n".join(out) + "\n</svg>\n"


if __name__ == "__main__":
    names = [line for line in (ROOT / "src" / "modules.txt").read_text().split("\n") if re.match(r"[a-z]", line)]
    (ROOT / "doc" / "images" / "modules.svg").write_text(svg(names))
