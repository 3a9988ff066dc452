"""In plain Python, in the folder where the program has made bed.hdf of bed.toml: arrays, errors, files, ensembles, time."""
import ast
import contextlib
import gc
import io
import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import textwrap
import threading
import time
import tomllib
import unittest
import unittest.mock
from pathlib import Path

import numpy as np

import packmpi
from packmpi import toml

TEXT = Path("bed.toml").read_text()
KEYS = tomllib.loads(TEXT)
# Twenty lines, counted by the test: import to arrays of ten thousand spheres.
SHORT = """
import packmpi
pack = packmpi.run({
    "fidelity": "draft",
    "container": {"size": [1.2, 1.2, 0.3], "boundary": ["periodic", "periodic"]},
    "particles": {"density": 2650.0, "youngs_modulus": "30 MPa", "poisson_ratio": 0.25,
                  "radius": {"distribution": "grading", "weighting": "mass",
                             "diameter_curve": [["30 mm", 0], ["38 mm", 60], ["45 mm", 100]]}},
    "layers": {"thickness": 0.2, "fraction": 0.25},
    "jamming": {"gravity": 9.81},
    "contact": {"friction": 0.3, "damping_ratio": 0.3}})
position, radius, force = pack.position, pack.radius, pack.forces
"""


def arguments_of_stub(body):
    """What a stub declares: of a function the number of its arguments, of a class what it declares, of all else nothing."""
    told = {}
    for one in body:
        if isinstance(one, ast.FunctionDef):
            told[one.name] = None if any(isinstance(by, ast.Name) and by.id == "property" for by in one.decorator_list) else len(one.args.args)
        elif isinstance(one, ast.ClassDef):
            told[one.name] = arguments_of_stub(one.body)
        elif isinstance(one, ast.AnnAssign):
            told[one.target.id] = None
    return told


def arguments_of(compiled):
    """The same of what was compiled; pybind11 writes each argument into a function's first line as "arg0: int"."""
    told = {}
    for name, one in vars(compiled).items():
        if not name.startswith("_"):
            words = (getattr(compiled, name).__doc__ or "").splitlines() if callable(getattr(compiled, name)) else []
            told[name] = arguments_of(one) if isinstance(one, type) else len(re.findall(r"\b(?:arg[0-9]+|self): ", words[0])) if words else None
    return told


class Arrays(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.pack = packmpi.run("bed.toml")

    def test_are_those_of_the_program(self):
        made = packmpi.read("bed.hdf")
        for name in ("id", "position", "radius", "velocity", "spin", "layer", "contacts", "pairs", "forces"):
            np.testing.assert_array_equal(getattr(self.pack, name), getattr(made, name), name)
        self.assertEqual(sorted(self.pack.pair_contacts), sorted(made.pair_contacts))
        self.assertEqual({k: v for k, v in made.summary.items() if k != "units"}, self.pack.summary)
        self.assertEqual(made.rest, self.pack.rest)
        self.assertEqual(made.layers, self.pack.layers)

    def test_are_not_copied(self):
        made, position = self.pack._made, self.pack.position
        self.assertEqual(position.ctypes.data, made.address)            # the memory of C++ itself
        self.assertEqual(position.ctypes.data, made.position.ctypes.data)
        self.assertFalse(position.flags.owndata)
        self.assertFalse(position.flags.writeable)
        self.assertIs(position.base, made)
        self.assertTrue(position.flags.c_contiguous)
        self.assertEqual((position.dtype, self.pack.id.dtype), (np.float64, np.int64))

    def test_live_as_long_as_they_are_used(self):
        position = packmpi.run("bed.toml").position   # the pack is gone
        gc.collect()
        np.testing.assert_array_equal(position, self.pack.position)

    def test_of_discs(self):
        pack = packmpi.run({**KEYS, "container": {"dimension": 2, "size": [0.4, 0.2]}, "contact": {"friction": 0.0},
                            "dynamics": {"rotation": False}})
        self.assertEqual((pack.dimension, pack.noun, pack.spin), (2, "discs", None))
        self.assertTrue(np.all(pack.position[:, 2] == 0.0))
        self.assertNotIn("tangential_displacement", pack.pair_contacts)


class Scenes(unittest.TestCase):
    def test_dictionary_text_and_file_are_one(self):
        file = packmpi.scene("bed.toml")
        self.assertEqual(packmpi.scene(TEXT).text, file.text)
        self.assertEqual(packmpi.scene(KEYS).text, file.text)
        self.assertEqual(packmpi.scene(Path("bed.toml")).name, "bed")
        self.assertEqual(packmpi.scene(KEYS, name="other").name, "other")
        self.assertEqual(packmpi.scene(file.text).keys(), file.keys())

    def test_changes(self):
        scene = packmpi.scene("bed.toml", set={"layers.duration": 0.5, "container.boundary": ["periodic", "wall"]}, seed=9)
        self.assertEqual((scene.keys()["layers"]["duration"], scene.keys()["seed"]), (0.5, 9))

    def test_toml_is_read_as_it_was(self):
        odd = {"a": 1, "b": [1.5, -0.0, 1e-300], "c": 'a "b" \\ \n\tü\x01', "t": {"k": True, "in": {"x y": [["3 mm", 0]]}}}
        self.assertEqual(tomllib.loads(toml.dumps(odd)), odd)
        numbers = {"n": np.int32(3), "x": np.float32(0.5), "v": np.arange(3.0), "b": np.bool_(True)}
        self.assertEqual(tomllib.loads(toml.dumps(numbers)), {"n": 3, "x": 0.5, "v": [0.0, 1.0, 2.0], "b": True})

    def test_errors_have_key_and_line(self):
        cases = [(TEXT.replace("size =", "siez ="), "container.siez", 3), (TEXT + "[jammin]\n", "jammin", 21), ("a = = 1\n", "", 1),
                 (TEXT.replace("0.15", "0.9"), "layers.fraction", 11)]
        for text, key, line in cases:
            with self.subTest(key=key), self.assertRaises(packmpi.SceneError) as raised:
                packmpi.scene(text, name="mine")
            error = raised.exception
            self.assertEqual((error.key, error.line, error.file, error.code), (key, line, "mine.toml", 2), str(error))
        with self.assertRaises(packmpi.SceneError) as raised:
            packmpi.scene("bed.toml", set={"layers.fraction": 0.9})
        self.assertEqual((raised.exception.key, raised.exception.line), ("layers.fraction", 0))
        with self.assertRaises(packmpi.SceneError) as raised:
            packmpi.scene({"container": {"size": object()}})
        self.assertEqual(raised.exception.key, "container.size")
        for wrong in ("none.toml", "."):
            with self.assertRaises(packmpi.Problem):
                packmpi.scene(wrong)
        for wrong in ("", "folder/name"):
            with self.assertRaisesRegex(packmpi.SceneError, "no name of files"):
                packmpi.scene(KEYS, name=wrong)
        with self.assertRaises(ValueError):   # a SceneError is one
            packmpi.scene("a = 1\n")

    def test_check_and_estimate(self):
        facts = packmpi.scene("bed.toml").check()
        self.assertLess(0.0, facts["time_step"])
        self.assertLessEqual(facts["time_step"], facts["time_step_limit"])
        self.assertGreater(facts["most_ranks"], 1)
        self.assertEqual(facts["warnings"], [])
        soft = packmpi.scene("bed.toml", set={"particles.youngs_modulus": 1e4}).check()
        self.assertIn("particles.youngs_modulus", soft["warnings"][0])
        told = packmpi.scene("bed.toml").estimate(particles=1000, ranks=2, probe=False)
        self.assertEqual((told["found"], told["ranks"]), ("height", 2))
        self.assertLess(abs(told["particles"]["value"] - 1000), 200)
        told = packmpi.scene("bed.toml").estimate(particles=1000, floor=[0.5, None], probe=False)
        self.assertEqual((told["found"], told["size"][0]), ("floor", 0.5))


class Files(unittest.TestCase):
    def test_in_memory_nothing_is_left(self):
        before = set(Path(".").iterdir())
        pack = packmpi.run("bed.toml")
        self.assertIn("contacts", pack.analyze())
        files = pack.convert("lammps", "here.lammps.data", force=True)
        self.assertTrue(all(file.exists() for file in files))
        del pack
        gc.collect()
        left = {path.name for path in set(Path(".").iterdir()) - before} - {file.name for file in files}
        self.assertEqual(left, set())

    def test_a_specimen_is_cut_out(self):
        shape, file = "box:length=0.25,width=0.15,height=0.08", "part.csv"
        part = packmpi.read("bed.hdf").convert("csv", file, cut=shape, force=True)
        said = subprocess.run([os.environ["PACKMPI_PROGRAM"], "convert", "bed.hdf", "--to", "csv", "--cut", shape, "-o", "by_program.csv", "--force"],
                              check=True, capture_output=True, text=True).stdout
        self.assertEqual(list(part), [Path(file)])
        self.assertEqual(Path(file).read_bytes(), Path("by_program.csv").read_bytes())
        self.assertIn(f"by_program.csv: {part.particles} of {packmpi.read('bed.hdf').count} particles", said)
        self.assertIn(f"cut out: {part.cut}; solid fraction {part.cut_fraction:.9f}", said)
        self.assertTrue(0 < part.particles < packmpi.read("bed.hdf").count)
        with self.assertRaisesRegex(packmpi.Problem, "periodic"):
            packmpi.read("bed.hdf").convert("csv", file, copies=(2, 1), force=True)

    def test_a_record_stands_beside_the_page(self):
        pack = packmpi.run("bed.toml", folder="archived", force=True)
        page = pack.report(size=150, crate="CC-BY-4.0")
        record = json.loads((page.parent / "ro-crate-metadata.json").read_text())
        self.assertIn({"@id": page.name}, record["@graph"][1]["hasPart"])
        with self.assertRaises(packmpi.Problem):
            packmpi.run("bed.toml").report("page.html", crate="CC-BY-4.0")

    def test_what_a_report_lacks_is_said(self):
        drawing = {name: None for name in sys.modules if name.split(".")[0] == "matplotlib"} | {"matplotlib": None}
        with unittest.mock.patch.dict(sys.modules, drawing):
            for name in ("report", "plot", "render", "render_2d"):
                sys.modules.pop(f"packmpi.{name}", None)
            with self.assertRaisesRegex(packmpi.Problem, "apt-get install python3-matplotlib"):
                packmpi.read("bed.hdf").report("none.html")

    def test_wishes_that_cannot_be(self):
        pack = packmpi.run("bed.toml")
        for wish in (lambda: pack.convert("lammps"), pack.report, lambda: pack.convert("no_format", "x"),
                     lambda: packmpi.read("none.hdf"), lambda: packmpi.read("bed.toml"), lambda: packmpi.run("bed.toml", comm=3),
                     lambda: packmpi.ensemble("bed.toml", "x"), lambda: pack.save("no_such/folder/x.hdf"),
                     lambda: packmpi.run("bed.toml", folder="x", restart="none.hdf")):
            with self.assertRaises(packmpi.Problem):
                wish()

    def test_what_is_placed_and_not_moved(self):
        pack = packmpi.run({"container": {"size": [0.1, 0.1, 0.1]}, "layers": {"duration": 0, "fraction": 0.1},
                            "particles": {"density": 2650, "youngs_modulus": 1e8, "poisson_ratio": 0.2,
                                          "radius": {"distribution": "equal", "value": 0.008}}}, folder="placed")
        self.assertEqual(pack.rest["support_limit"], math.inf)   # asked for nothing, as the file says
        self.assertEqual(packmpi.read("placed/scene.hdf").rest, pack.rest)
        pack.report("placed/page.html")
        page = Path("placed/page.html").read_text(encoding="utf-8")
        self.assertIn("one, inserted and not moved", page)
        self.assertIn("the fraction of the layer was reached", page)

    def test_ensemble(self):
        scene = packmpi.scene("bed.toml", set={"ensemble.packs": 2, "container.size": [0.2, 0.2, 0.05]})
        with self.assertRaises(packmpi.SceneError) as raised:
            packmpi.run(scene)
        self.assertIn("ensemble", str(raised.exception))
        told = []
        both = packmpi.ensemble(scene, "both", force=True, progress=lambda *now: told.append(now))
        self.assertEqual((told[0], told[-1]), ((0, 2), (2, 2)))
        self.assertEqual(told, sorted(set(told)))
        self.assertEqual(len(both), 2)
        self.assertEqual([pack.provenance["seed"] for pack in both], [3, 4])

    def test_checkpoint_and_on(self):
        with self.assertRaises(packmpi.Problem) as raised:
            packmpi.run("bed.toml", folder="cut", max_hours=1e-9, force=True)
        self.assertEqual(raised.exception.code, 75)
        pack = packmpi.run("bed.toml", folder="cut", restart="auto")
        np.testing.assert_array_equal(pack.position, packmpi.read("bed.hdf").position)


class Page(unittest.TestCase):
    def test_runs_as_it_stands(self):
        """doc/python.md from top to bottom, its first scene made small."""
        root = Path(__file__).resolve().parents[2]
        blocks = re.findall(r"^```python\n(.*?)^```$", (root / "doc" / "python.md").read_text(), re.MULTILINE | re.DOTALL)
        self.assertGreater(len(blocks), 4)
        blocks[0] = blocks[0].replace('packmpi.run("input/quickstart.toml")',
                                      'packmpi.run(packmpi.scene("input/quickstart.toml", set={"container.size": [0.3, 0.3, 0.2]}))')
        place, names = Path("page"), {}
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir()
        (place / "input").symlink_to(root / "input")
        with contextlib.chdir(place), contextlib.redirect_stdout(io.StringIO()) as said:
            for block in blocks:
                exec(compile(block, "doc/python.md", "exec"), names)   # pylint: disable=exec-used
        self.assertIn('container.siez 3 scene.toml:3: container.siez: unknown key; did you mean "size"?', said.getvalue())
        self.assertIn("11610 False", said.getvalue())
        self.assertEqual(names["again"].phi_bulk, names["pack"].phi_bulk)


class Manners(unittest.TestCase):
    def test_progress(self):
        told = []
        packmpi.run("bed.toml", progress=told.append)
        self.assertEqual(told[0].stage, "inserting")
        self.assertTrue(all(0.0 <= now.share <= 1.0 for now in told))
        self.assertGreater(told[-1].height, 0.0)

    def test_control_c(self):
        threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
        begun = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            packmpi.run("bed.toml", progress=lambda now: time.sleep(0.02), )
            time.sleep(5.0)
        self.assertLess(time.monotonic() - begun, 4.0)

    def test_import_starts_no_mpi(self):
        words = "import packmpi, sys; packmpi.Pack; sys.exit('packmpi._core' in sys.modules)"
        self.assertEqual(subprocess.run([sys.executable, "-c", words], check=False).returncode, 0)

    def test_the_stub_is_the_compiled_part(self):
        """_core.pyi, which mypy believes: the same names, and functions of as many arguments."""
        from packmpi import _core
        stub = ast.parse((Path(packmpi.__file__).parent / "_core.pyi").read_text(encoding="utf-8")).body
        self.assertEqual(arguments_of_stub(stub), arguments_of(_core))
        self.assertIn("convert", arguments_of(_core))

    def test_many_in_few_lines_and_seconds(self):
        lines = [line for line in SHORT.splitlines() if line.strip()]
        self.assertLess(len(lines), 20)
        check = textwrap.dedent("""
            import resource
            assert position.shape == (len(radius), 3) and len(radius) > 10_000 and force.shape[1] == 3, len(radius)
            assert 0.55 < pack.phi_bulk < 0.66, pack.phi_bulk
            print(len(radius), "spheres:", resource.getrusage(resource.RUSAGE_SELF).ru_utime, "s of this process")
            assert resource.getrusage(resource.RUSAGE_SELF).ru_utime < 10.0
            """)
        self.assertEqual(subprocess.run([sys.executable, "-c", SHORT + check], check=False).returncode, 0)


if __name__ == "__main__":
    unittest.main()
