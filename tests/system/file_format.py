#!/usr/bin/python3
"""Makes three small packs and compares them with the tables of doc/file_format.md, both ways.

usage: file_format.py ROOT FOLDER -- mpirun ... packmpi
The first pack has spin and contacts that remember, the second contacts that do not, the third neither. Exit code 77: h5py is missing.
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys

try:
    import h5py
    import numpy as np
except ImportError as error:
    print(f"skipped: the Python package {error.name} is missing (scripts/setup.sh --plots)")
    sys.exit(77)

SMALL = ["--set", "layers.duration=0.01", "--set", "layers.maximum=2", "--set", "rest.wait=0", "--quiet"]  # stops short of the height: exit 3
TYPES = {"float64": "<f8", "int64": "<i8", "uint64": "<u8", "int32": "<i4", "uint8": "|u1"}
ROW = re.compile(r"^\| `(/[^`]+)` \|([^|]*)\|([^|]*)\|([^|]*)\|$")

problems = []


def expect(condition, words):
    if not condition:
        problems.append(words)


def documented(text):
    """path -> (shape and type, unit, meaning) of all tables."""
    rows = [ROW.match(line) for line in text.splitlines()]
    return {row[1]: tuple(cell.strip() for cell in row.groups()[1:]) for row in rows if row}


def contents(file):
    """path -> dataset or attribute value, in the page's notation; `unit` is not listed there."""
    found = {"/@" + name: value for name, value in file.attrs.items()}

    def visit(path, thing):
        if isinstance(thing, h5py.Dataset):
            found["/" + path] = thing
        else:
            found.update({f"/{path}/@{name}": value for name, value in thing.attrs.items()})

    def walk(group, path):  # h5py's visititems() passes over second names of a dataset
        for name in group:
            visit(path + name, group[name])
            if isinstance(group[name], h5py.Group):
                walk(group[name], path + name + "/")

    walk(file, "")
    return found


def has_type(value, kind):
    """`kind` as the page writes it: "(N, 3) float64", "text"."""
    shape, name = re.match(r"(?:\((.*)\) )?(\w+)$", kind).groups()
    array = value if isinstance(value, h5py.Dataset) else np.asarray(value)
    axes = len(shape.split(",")) if shape else 0
    return array.ndim == axes and (array.dtype.kind in "SU" if name == "text" else array.dtype == np.dtype(TYPES[name]))


def text(value):
    """Attributes in UTF-8 come as str or as bytes, depending on the version of h5py."""
    return value.decode() if isinstance(value, bytes) else value


def check_units(pack, table):
    listed = dict(item.split(": ") for item in text(pack["summary"].attrs["units"]).split("; "))
    for path, (_, unit, _) in table.items():
        if path.startswith("/summary/@") and path != "/summary/@units":
            name = path.split("@")[1]
            expect(listed.get(name, "") == unit, f"{path}: unit {listed.get(name)!r} in the file, {unit!r} on the page")
        elif "@" not in path and path in pack:
            there = text(pack[path].attrs.get("unit", ""))
            expect(there == unit, f"{path}: unit {there!r} in the file, {unit!r} on the page")


def check_pack(path, table, absent):
    with h5py.File(path, "r") as pack:
        found = contents(pack)
        wanted = {name for name in table if not name.startswith(absent)}
        for name in sorted(wanted - set(found)):
            expect(False, f"{path.name}: {name} is on the page, but not in the file")
        for name in sorted(set(found) - wanted):
            expect(False, f"{path.name}: {name} is in the file, but not on the page (for this scene)")
        for name in wanted & set(found):
            expect(has_type(found[name], table[name][0]), f"{path.name}: {name} is not {table[name][0]}")
        for name in found:
            if "link" in table.get(name, ("", "", ""))[2]:
                own = {"Points": "position", "Connectivity": "id"}.get(name.split("/")[-1], name.split("/")[-1])
                expect(pack[name] == pack["particles/" + own], f"{name} is not a hard link to /particles/{own}")
        expect(list(pack["particles/id"]) == list(range(len(pack["particles/id"]))), "row k is not particle k")
        check_units(pack, table)


def check_json(path, table, page):
    summary = json.loads(path.read_text())
    expect(("composition" in summary) == (path.stem == "components"), f"{path.name}: composition is of several components")
    summary.pop("composition", None)
    names = {part: {name.split("@")[1] for name in table if name.startswith(f"/{group}/@")}
             for part, group in (("summary", "summary"), ("audit", "summary/audit"), ("provenance", "provenance"))}
    expect(set(summary) == {"format", "format_version", "target", "achieved", "sizes", "audit", "rest", "missed", "layers", "counters", "costs",
                            "moving_share", "provenance", "seal", "units"}, f"{path.name}: parts are {sorted(summary)}")
    for part in ("counters", "costs"):
        expect(set(summary[part]) == set(re.findall(rf"`{part}\.(\w+)`", page)),
               f"{path.name}: {part} are {sorted(summary[part])}")
        expect(all(len(numbers["of_rank"]) == summary["provenance"]["ranks"] and sum(numbers["of_rank"]) == numbers["sum"]
                   and max(numbers["of_rank"]) == numbers["max"] for numbers in summary[part].values()), f"{path.name}: {part}")
    expect(set(summary["target"]) | set(summary["achieved"]) == names["summary"] - {"units"}, f"{path.name}: target, achieved")
    for weighting in ("number", "mass"):
        sizes = summary["sizes"][weighting]
        points = {f"d{percent}" for percent in (10, 30, 50, 60, 90)} | {"cu", "cc"}
        expect(set(sizes) == {"target", "achieved", "distance"}, f"{path.name}: sizes by {weighting}")
        expect(set(sizes["target"]) == points and set(sizes["achieved"]) == points, f"{path.name}: sizes by {weighting}")
    measures = {name.split("@")[1] for name in table if name.startswith("/summary/rest/@")} - {"missed"}
    expect(set(summary["rest"]) == {name for name in measures if not name.endswith("_limit")}, f"{path.name}: rest")
    expect(bool(summary["missed"]), f"{path.name}: a target is missed here, and not named")
    expect(set(summary["audit"]) == names["audit"], f"{path.name}: audit")
    expect(set(summary["provenance"]) == names["provenance"], f"{path.name}: provenance")
    columns = {name.split("/")[-1] for name in table if name.startswith("/summary/layers/")}
    expect(all(set(row) == columns | {"layer"} for row in summary["layers"]), f"{path.name}: layers")


def check_steps(path, page):
    lines = path.read_text().splitlines()
    expect(lines[0] in page.splitlines(), f"{path.name}: the header is not the page's: {lines[0]}")
    expect(len(lines) > 1 and all(line.count(",") == lines[0].count(",") for line in lines), f"{path.name}: rows")


def check_confined(path, table, page):
    """Under a stress the summary has what the page's paragraph on it names, beside what every pack has."""
    paragraph = next(part for part in page.split("\n\n") if part.startswith("Under a stress"))
    named = set(re.findall(r"`(\w+)`", paragraph)) - {"steps", "phi", "phi_bulk", "bulk"}
    with h5py.File(path, "r") as pack:
        there = {name for name in pack["summary"].attrs if f"/summary/@{name}" not in table}
        expect(there == named, f"{path.name}: under a stress: {sorted(there)} in the file, {sorted(named)} on the page")


def main():
    root, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    program = sys.argv[sys.argv.index("--") + 1:]
    page = (root / "doc" / "file_format.md").read_text()
    table = documented(page)
    expect(len(table) > 50, f"only {len(table)} rows could be read from the page")
    shutil.rmtree(folder, ignore_errors=True)
    rolling, memory = "contact.rolling_friction=0.1", 'contact.tangential="mindlin"'
    springs = [f"/{group}/{kind}_displacement" for group in ("contacts", "wall_contacts") for kind in ("tangential", "rolling", "twisting")]
    graded, mixed = root / "input" / "graded_uniform.toml", root / "tests" / "scenes" / "components.toml"
    alone = ("/particles/component", "/VTKHDF/PointData/component")
    cases = {"all": (graded, ["output.contacts=true", memory, rolling], alone),
             "sliding": (graded, ["output.contacts=true", 'contact.tangential="sliding"'], (*springs, *alone)),
             "bare": (graded, ["output.contacts=false", "dynamics.rotation=false"],
                      ("/contacts", "/wall_contacts", "/particles/spin", "/VTKHDF/PointData/spin", *alone)),
             "components": (mixed, ["output.contacts=false"], ("/contacts", "/wall_contacts"))}

    def make(case, scene, sets):
        arguments = [word for one in sets for word in ("--set", one)]
        command = [*program, str(scene), *SMALL, *arguments, "-o", str(folder / case)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 3:
            sys.exit(f"exit code {done.returncode}:\n{done.stdout}{done.stderr}")

    confined = root / "input" / "confined.toml"
    make("confined", confined, ["confinement.wait=1e-4"])
    check_confined(folder / "confined" / f"{confined.stem}.hdf", table, page)
    for case, (scene, sets, absent) in cases.items():
        make(case, scene, sets)
        check_pack(folder / case / f"{scene.stem}.hdf", table, absent)
        check_json(folder / case / f"{scene.stem}.json", table, page)
        check_steps(folder / case / f"{scene.stem}.steps.csv", page)
        expect((folder / case / f"{scene.stem}.log").exists(), "there is no log")
    print("\n".join(problems) or f"{len(table)} names compared")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
