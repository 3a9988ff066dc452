"""The JSON Schema of scene files takes every scene we ship and what `packmpi init` writes, and refuses slips.

usage: scene_schema.py PROGRAM FOLDER_OF_SCENES
"""
import json
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

try:
    import jsonschema
except ImportError:
    print("scene_schema: needs python3-jsonschema (scripts/setup.sh --plots)")
    sys.exit(77)   # skipped, for ctest

SLIPS = {"container.dimension": 4, "container.size": "big", "layers.fraction": 1.5, "layers.fractoin": 0.2,
         "particles.radius.distribution": "even", "dynamics.rotation": "yes", "seed": -1, "contakt": {}}


def run(*words):
    return subprocess.run([PROGRAM, *words], check=True, text=True, stdout=subprocess.PIPE).stdout


def changed(scene, path, value):
    """A copy with one key changed; None: taken away."""
    scene = json.loads(json.dumps(scene))
    *tables, name = path.split(".")
    table = scene
    for key in tables:
        table = table.setdefault(key, {})
    table[name] = value
    if value is None:
        del table[name]
    return scene


PROGRAM, folder = sys.argv[1:]
schema = json.loads(run("schema"))
jsonschema.Draft7Validator.check_schema(schema)
check = jsonschema.Draft7Validator(schema)
with tempfile.TemporaryDirectory() as work:
    begun = []
    for dimension in ("2", "3"):
        begun.append(Path(work) / f"scene_{dimension}.toml")
        run("init", str(begun[-1]), "--dimension", dimension)
        run("check", str(begun[-1]))
    again = subprocess.run([PROGRAM, "init", str(begun[0])], text=True, stderr=subprocess.PIPE)
    assert again.returncode == 2 and "exists; use --force" in again.stderr, again
    scenes = [*Path(folder).glob("*.toml"), *begun]
    for path in scenes:
        errors = [error.message for error in check.iter_errors(tomllib.loads(path.read_text()))]
        assert not errors, (path, errors)
    valid = tomllib.loads(begun[1].read_text())
for path, value in [*SLIPS.items(), ("layers.thickness", None), ("particles.radius", None), ("jamming", None)]:
    assert not check.is_valid(changed(valid, path, value)), f"{path} = {value} was taken"
assert check.is_valid(changed(changed(changed(valid, "layers.duration", 0), "layers.thickness", None), "jamming", None))
diameter = changed(changed(valid, "particles.diameter", {"distribution": "list", "diameters": [0.01]}), "particles.radius", None)
assert check.is_valid(diameter) and not check.is_valid(changed(diameter, "particles.radius", valid["particles"]["radius"]))
print(f"{len(scenes)} scenes taken, {len(SLIPS) + 3} slips refused")
