"""The Python package: sizes by hand, a pack made here, the command line without what it needs. usage: python3 -m unittest"""
import contextlib
import hashlib
import io
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import h5py
    import matplotlib  # noqa: F401
    import numpy as np
except ImportError as error:
    print(f"skipped: the Python package {error.name} is missing (scripts/setup.sh --plots)")
    sys.exit(77)

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "python"
sys.path.insert(0, str(FOLDER))

from packmpi import Pack, Problem, __main__ as command, crate, plot, render, render_2d, sizes, units, vessel  # noqa: E402


def make_pack(path, **attributes):
    """Two discs, the smallest file that is a pack."""
    with h5py.File(path, "w") as file:
        file.attrs["format"] = "packmpi-pack"
        particles = file.create_group("particles")
        particles["position"] = [[0.1, 0.1, 0.0], [0.3, 0.15, 0.0]]
        particles["radius"] = [0.1, 0.15]
        particles["velocity"] = [[3.0, 4.0, 0.0], [0.0, 0.0, 0.0]]
        particles["layer"] = np.array([0, 1], np.int32)
        particles["contacts"] = np.array([0, 0], np.int32)
        summary = file.create_group("summary")
        summary.attrs.update({"size": [0.5, 0.2], "dimension": 2, "phi": 0.5, "phi_bulk": 0.6, **attributes})
        summary.create_group("audit")
        summary.create_group("layers")["inserted"] = [1, 1]
        file.create_group("provenance").attrs["effective_input"] = np.bytes_(b"seed = 7\n[layers]\nduration = 0.5\n")


class Packs(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.addCleanup(self.place.cleanup)
        self.path = pathlib.Path(self.place.name) / "two.hdf"

    def test_what_the_file_says(self):
        make_pack(self.path)
        pack = Pack(self.path)
        self.assertEqual((pack.count, pack.noun, pack.name), (2, "discs", "two"))
        np.testing.assert_array_equal(pack.speed, [5.0, 0.0])
        self.assertAlmostEqual(pack.top(), 0.3)   # above the target of 0.2
        self.assertEqual(pack.scene()["layers"]["duration"], 0.5)   # a text of bytes
        self.assertEqual(pack.layers, {"inserted": [1, 1]})
        self.assertIsNone(pack.pairs)
        self.assertEqual((pack.spin, pack.pair_contacts, pack.wall_contacts), (None, {}, {}))
        self.assertEqual(pack.steps(), {})

    def test_contacts_are_there_by_name(self):
        make_pack(self.path)
        with h5py.File(self.path, "a") as file:
            file["particles/spin"] = np.zeros((2, 3))
            file["contacts/pair"] = [[0, 1]]
            file["contacts/force"] = [[1.0, 0.0, 0.0]]
            file["contacts/tangential_displacement"] = [[0.0, 1e-6, 0.0]]
            file["wall_contacts/wall"] = np.array([0, 2], np.int32)
        pack = Pack(self.path)
        self.assertEqual(sorted(pack.pair_contacts), ["force", "pair", "tangential_displacement"])
        np.testing.assert_array_equal(pack.pair_contacts["tangential_displacement"], [[0.0, 1e-6, 0.0]])
        np.testing.assert_array_equal(pack.wall_contacts["wall"], [0, 2])
        np.testing.assert_array_equal(pack.pairs, pack.pair_contacts["pair"])
        self.assertEqual(pack.spin.shape, (2, 3))

    def test_history_has_its_columns(self):
        make_pack(self.path)
        self.path.with_suffix(".steps.csv").write_text("step,time [s],top [m]\n0,0.0,0.1\n5,0.5,0.2\n")
        steps = Pack(self.path).steps()
        np.testing.assert_array_equal(steps["time"], [0.0, 0.5])
        np.testing.assert_array_equal(steps["top"], [0.1, 0.2])

    def test_a_former_version_has_the_names_of_today(self):
        pack = Pack(FOLDER.parents[1] / "tests" / "formats" / "bed.pack-1.hdf")
        self.assertEqual(pack.count, 18)
        self.assertEqual(pack.summary["target_height"], pack.size[-1])
        self.assertEqual(len(pack.layers["achieved_fraction"]), len(pack.layers["inserted"]))
        self.assertLessEqual({"compaction_rate", "relaxations", "relaxation_steps", "target_fraction"}, set(pack.summary))
        self.assertIn("relaxation", pack.scene()["dynamics"])

    def test_no_pack(self):
        with self.assertRaisesRegex(Problem, "cannot read"):
            Pack(self.path)
        with h5py.File(self.path, "w") as file:
            file.attrs["format"] = "another"
        with self.assertRaisesRegex(Problem, "is not a pack of packmpi"):
            Pack(self.path)
        with h5py.File(self.path, "w") as file:
            file.attrs["format"] = "packmpi-pack"
        with self.assertRaisesRegex(Problem, "is incomplete"):
            Pack(self.path)


class Pictures(unittest.TestCase):
    def test_no_caption_is_cut_off(self):
        """In a picture of any width, and nothing of it is left out."""
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "two.hdf"
            make_pack(path, reached=1)
            pack = Pack(path)
        lines = []
        for pixels in (100, 250, 400, 1000):
            words = render.Caption(pack, pixels)
            self.assertLessEqual(max(render.width_of(line, words.points) for line in words.lines), pixels - 24, pixels)
            self.assertEqual(sorted(",  ".join(words.lines).split(",  ")), sorted(render.caption(pack)))
            self.assertGreater(words.height, len(words.lines) * words.points * 100 / 72)
            lines.append(len(words.lines))
        self.assertEqual(lines[-1], 1)
        self.assertGreater(lines[1], 1)


class Sections(unittest.TestCase):
    def pack(self, scene=b"[container]\nboundary = ['wall', 'wall']\n", **attributes):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "cut.hdf"
            make_pack(path, **{"dimension": 3, "size": [0.5, 0.4, 0.2], **attributes})
            with h5py.File(path, "a") as file:
                file["particles/position"][:] = [[0.1, 0.26, 0.1], [0.3, 0.04, 0.2]]   # the plane is at 0.2
                file["provenance"].attrs["effective_input"] = np.bytes_(scene)
            return Pack(path)

    def test_circles_of_spheres_that_the_plane_cuts(self):
        cut = render_2d.cut_middle(self.pack())
        np.testing.assert_array_equal(cut.which, [0])
        np.testing.assert_allclose(cut.places, [[0.1, 0.1]])
        np.testing.assert_allclose(cut.radii, [0.08])

    def test_what_leaves_on_one_side_enters_on_the_other(self):
        pack = self.pack(b"[container]\nboundary = ['periodic', 'wall']\n")
        pack.position[0, 0] = 0.07
        cut = render_2d.cut_middle(pack)
        np.testing.assert_array_equal(cut.which, [0, 0])
        np.testing.assert_allclose(cut.places, [[0.07, 0.1], [0.57, 0.1]])

    def test_walls_stand_where_they_are(self):
        for words, wanted in (({"shape": "cylinder"}, {0.0, 0.5, 0.25}), ({"shape": "annulus", "inner_diameter": 0.2}, {0.0, 0.15, 0.35, 0.5}),
                              ({"shape": "frustum", "bottom_diameter": 0.3, "top_diameter": 0.5}, {0.0, 0.1, 0.25, 0.4, 0.5}),
                              ({"shape": "sphere"}, {0.0, 0.25, 0.5}), ({"shape": "circle"}, {0.0, 0.25, 0.5}),
                              ({"shape": "trapezium", "bottom_width": 0.3, "top_width": 0.5}, {0.0, 0.5}), ({"shape": "polygon"}, {0.0, 0.4})):
            pack = self.pack(b"[container]\npolygon = [[0.3, 1.0], [0.7, 1.0], [0.5, 1.4]]\n", size=[0.5, 0.5, 0.5], **words)
            sheet = render_2d.new_sheet(pack, 300)
            render_2d.put_vessel(sheet, pack)
            ends = {round(float(x), 6) for line in sheet.axes.lines for x in (min(line.get_xdata()), max(line.get_xdata()))}
            render_2d.plt.close(sheet.figure)
            self.assertEqual(ends, wanted, words)

    def test_of_a_wide_bed_the_middle_is_seen(self):
        for width in (0.5, 10.0):
            pack = self.pack(size=[width, 0.5, 0.5])
            sheet = render_2d.new_sheet(pack, 300, render_2d.WIDEST)
            seen = min(width, 5.0 * vessel.top(pack))
            np.testing.assert_allclose(sheet.axes.get_xlim(), [0.5 * (width - seen), 0.5 * (width + seen)])
            self.assertEqual(sheet.whole, seen == width)
            render_2d.plt.close(sheet.figure)

    def test_corners_of_trapezia_and_polygons(self):
        pack = self.pack(b"[container]\npolygon = [[0.3, 1.0], [0.7, 1.0], [0.5, 1.4]]\n", shape="polygon")
        np.testing.assert_allclose(vessel.corners(pack), [[0.0, 0.0], [0.4, 0.0], [0.2, 0.4], [0.0, 0.0]], atol=1e-15)
        pack = self.pack(size=[0.5, 0.4, 0.1], shape="trapezium", bottom_width=0.5, top_width=0.3)
        self.assertGreater(pack.top(), 0.25)
        np.testing.assert_allclose(vessel.corners(pack)[:3], [[0.25, 0.25], [0.1, 0.1], [0.0, 0.0]])   # 45 degrees, to the tip
        np.testing.assert_allclose(vessel.corners(pack)[3:, 0], 0.5 - vessel.corners(pack)[2::-1, 0])

    def test_of_triangles_the_lines_in_the_plane(self):
        points = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 1.0]])
        np.testing.assert_allclose(np.sort(vessel.section(points, np.array([[0, 1, 2]]), 0.5, 1)[0], axis=0), [[0.0, 0.5, 0.0], [0.5, 0.5, 0.5]])


    def test_rings_at_the_walls_of_a_vessel(self):
        pack = self.pack(shape="annulus", inner_diameter=0.2)
        profile = {"from": 0.0, "width": 0.025, "values": [0.1, 0.5, 0.7]}
        figure = plot.radial(pack, {"radial_profile": {"from_wall": profile, "from_inner_wall": profile, "core": {"solid_fraction": 0.6}}})
        axes, = figure.axes
        self.assertEqual([one.get_text() for one in axes.get_legend().get_texts()], ["from the outer wall", "from the inner wall", "of the core, away from walls"])
        np.testing.assert_allclose(axes.patches[0].get_data().edges, [0.0, 0.1, 0.2, 0.3])   # mean diameters of 0.25
        plot.plt.close(figure)
        self.assertIsNone(plot.radial(pack, {}))


class Crate(unittest.TestCase):
    def test_it_names_what_lies_beside_the_pack(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "two.hdf"
            make_pack(path, coordination=0.0, height=0.3)
            with h5py.File(path, "a") as file:
                file["provenance"].attrs.update({"seed": 7, "version": "0.2.0", "git": "abc", "scene_file": "two.toml", "compiler": "c", "architecture": "a"})
            path.with_suffix(".log").write_text("made\n")
            (path.parent / "other.log").write_text("of another\n")
            target = crate.write_record(Pack(path), "CC-BY-4.0")
            told = {one["@id"]: one for one in json.loads(target.read_text())["@graph"]}
            self.assertEqual(told["ro-crate-metadata.json"]["conformsTo"], {"@id": "https://w3id.org/ro/crate/1.1"})
            self.assertEqual(told["./"]["hasPart"], [{"@id": "two.hdf"}, {"@id": "two.log"}])
            self.assertEqual(told["./"]["license"], {"@id": "https://spdx.org/licenses/CC-BY-4.0"})
            self.assertEqual(told["two.log"]["sha256"], hashlib.sha256(b"made\n").hexdigest())
            self.assertEqual((told["two.log"]["contentSize"], told["#porosity-of-the-bulk"]["value"]), ("5", 0.4))
            links = [part["@id"] for one in told.values() for value in one.values() for part in (value if isinstance(value, list) else [value])
                     if isinstance(part, dict) and not part["@id"].startswith("https://w3id")]
            self.assertLessEqual(set(links), set(told))   # nothing is named that is not there
            crate.write_record(Pack(path), "CC0-1.0")     # its own is replaced
            path.rename(path.with_name("three.hdf"))
            with self.assertRaisesRegex(Problem, "the record of other files"):
                crate.write_record(Pack(path.with_name("three.hdf")), "CC0-1.0")


class Sizes(unittest.TestCase):
    def test_two_radii(self):
        """Half of the mass in radius 1, half in 2: eight small ones for a large one."""
        r, number, mass = sizes.target_curve({"distribution": "bidisperse", "small": 1.0, "large": 2.0, "large_share": 0.5,
                                              "weighting": "mass"})
        np.testing.assert_array_equal(r, [1.0, 1.0, 2.0, 2.0])
        np.testing.assert_allclose(mass, [0.0, 0.5, 0.5, 1.0])
        np.testing.assert_allclose(number, [0.0, 8.0 / 9.0, 8.0 / 9.0, 1.0])

    def test_uniform(self):
        """Uniform by number from 1 to 3: the mass up to r is (r^4 - 1) / 80."""
        r, number, mass = sizes.target_curve({"distribution": "uniform", "min": 1.0, "max": 3.0, "weighting": "number"})
        np.testing.assert_allclose(np.interp(2.0, r, number), 0.5, atol=1e-6)
        np.testing.assert_allclose(np.interp(2.0, r, mass), 15.0 / 80.0, atol=1e-5)

    def test_grading_is_of_diameters(self):
        radius = {"distribution": "grading", "weighting": "mass", "diameter_curve": [[0.02, 0.0], [0.04, 100.0]], "interpolation": "linear"}
        r, _, mass = sizes.target_curve(radius)
        self.assertEqual((r[0], r[-1]), (0.01, 0.02))
        self.assertAlmostEqual(np.interp(0.015, r, mass), 0.5)
        self.assertAlmostEqual(sizes.target_curve({**radius, "keep_percent": [50.0, 100.0]})[0][0], 0.015)

    def test_achieved(self):
        r, number, mass = sizes.achieved_curve(np.array([2.0, 1.0]))
        np.testing.assert_array_equal(r, [1.0, 2.0])
        np.testing.assert_allclose(number, [0.5, 1.0])
        np.testing.assert_allclose(mass, [1.0 / 9.0, 1.0])

    def test_units(self):
        for length, factor, name in ((2.0, 1.0, "m"), (0.02, 1e3, "mm"), (2e-5, 1e6, "µm"), (2e-8, 1e9, "nm")):
            self.assertEqual(units.length_unit(length), (factor, name))


class CommandLine(unittest.TestCase):
    def start(self, *words, cwd=None, **environment):
        return subprocess.run([sys.executable, FOLDER / "packmpi" / "__main__.py", *words], text=True, capture_output=True, check=False,
                              cwd=cwd, env={**os.environ, **environment})

    def test_usage(self):
        self.assertEqual(self.start().returncode, 2)
        self.assertEqual(self.start("paint", "x.hdf").returncode, 2)

    def test_one_line_for_what_is_missing(self):
        """A package that is not installed is named with Debian's name for it; so is a file that is not there."""
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "h5py.py").write_text("raise ModuleNotFoundError(\"No module named 'h5py'\", name='h5py')\n")
            done = self.start("plot", "x.hdf", PYTHONPATH=folder)
        self.assertEqual(done.returncode, 5)
        self.assertRegex(done.stderr, r"^packmpi plot: the Python package h5py is missing for .*apt-get install python3-h5py .*\n$")
        done = self.start("plot", "/no/such.hdf")
        self.assertEqual(done.returncode, 5)
        self.assertRegex(done.stderr, r"^packmpi plot: cannot read /no/such.hdf: .*\n$")

    def test_the_folder_one_stands_in_is_not_searched(self):
        """A stranger's h5py.py beside the pack is not run."""
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "h5py.py").write_text("raise SystemExit('a stranger ran')\n")
            make_pack(pathlib.Path(folder) / "two.hdf", reached=1)
            done = self.start("render", "two.hdf", "--size", "400", cwd=folder)
        self.assertEqual((done.returncode, done.stdout), (0, "two.png: 2 particles by radius\n"), done.stderr)

    def test_words_name_the_command(self):
        said = io.StringIO()
        with contextlib.redirect_stderr(said), self.assertRaises(SystemExit):
            command.run(["report"])
        self.assertIn("usage: packmpi report", said.getvalue())

    def test_an_empty_name_is_no_folder(self):
        for tool in command.COMMANDS:
            said = io.StringIO()
            with contextlib.redirect_stderr(said), self.assertRaises(SystemExit) as end:
                command.run([tool, "/no/such.hdf", "-o", ""])
            self.assertEqual(end.exception.code, 2)
            self.assertIn("-o/--output: the name is empty", said.getvalue())


if __name__ == "__main__":
    unittest.main()
