#!/usr/bin/python3
"""The page of packmpi report in a real browser: all is drawn, nothing is fetched, nothing complains, the numbers are right.

usage: report.py ROOT FOLDER -- mpirun ... packmpi
A graded pack in 3D and discs in 2D. Exit code 77: Chromium or a Python package is missing (scripts/setup.sh --report).
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import browser

try:
    import h5py
    import numpy as np
    import matplotlib  # noqa: F401
except ImportError as error:
    print(f"skipped: the Python package {error.name} is missing (scripts/setup.sh --report)")
    sys.exit(77)

SMALL = ["--set", "layers.maximum=2", "--set", "layers.duration=0.015", "--set", "rest.wait=0", "--set", "rest.unbalanced_force=1e9", "--set", "rest.kinetic_energy=1e9",
         "--set", "rest.support=1e9", "--set", "output.contacts=true", "--quiet"]
SCENES = {"grading": ["--set", 'container.size=["80 mm", "80 mm", "60 mm"]', "--set", "layers.duration=0.12"], "periodic_2d": ["--set", "layers.duration=0.5"]}
ROWS = """[...document.querySelectorAll('#targets tr')].map(row => [...row.children].map(cell => cell.textContent))"""
IMAGES = """Promise.all([...document.images].map(image => image.decode().then(() => [image.alt, image.naturalWidth],
                                                                             () => [image.alt, 0])))"""
# The contrast of text and paper, by the formula of WCAG 2.
CONTRAST = """(() => {
  const light = colour => colour.match(/[0-9.]+/g).slice(0, 3).map(one => one / 255)
    .map(one => one <= 0.04045 ? one / 12.92 : ((one + 0.055) / 1.055) ** 2.4)
    .reduce((sum, one, k) => sum + one * [0.2126, 0.7152, 0.0722][k], 0);
  const paper = light(getComputedStyle(document.body).backgroundColor);
  return ['body', 'dt', 'thead th', 'figcaption', '.good'].map(where => {
    const ink = light(getComputedStyle(document.querySelector(where)).color);
    return (Math.max(ink, paper) + 0.05) / (Math.min(ink, paper) + 0.05);
  }).concat(paper);
})()"""

SECTIONS = ("grading",)   # discs are their own
PLOTS = {"grading": 8, "periodic_2d": 6}   # both are too small for g(r), discs are of one size
VIEW = """(() => {
  const view = document.getElementById('view');
  const set = (where, value, event) => { const one = view.querySelector(where); one.value = value; one.dispatchEvent(new Event(event)); };
  const whole = packmpiView.colours(), fields = [...view.querySelectorAll('select.field option')].map(one => one.textContent);
  set('input', 500, 'input');
  const half = packmpiView.colours();
  set('input', 0, 'input');
  const none = packmpiView.colours();
  view.querySelector('button').click();
  set('select.field', 1, 'change');
  return {spheres: packmpiView.spheres, whole, half, none, again: packmpiView.colours(), fields, high: view.querySelector('.high').textContent,
          sorry: view.querySelector('.sorry').textContent};
})()"""

# A drag across the view, and what is shown when it is over: all spheres, however few were drawn meanwhile.
TURN = """new Promise(done => {
  const canvas = document.querySelector('#view canvas'), box = canvas.getBoundingClientRect();
  const drag = (type, x) => canvas.dispatchEvent(new PointerEvent(type, {pointerId: 1, clientX: box.left + x, clientY: box.top + 90, buttons: 1, pointerType: 'mouse'}));
  const before = packmpiView.colours().covered;
  drag('pointerdown', 60);
  drag('pointermove', 180);
  drag('pointerup', 180);
  setTimeout(() => done([packmpiView.shown(), packmpiView.colours().covered !== before]), 1500);
})"""

problems = []


def check_view(page, path):
    """Spheres are drawn, all and cut, and coloured anew; sixteen colours at least."""
    name = path.stem
    told = page.value(VIEW)
    with h5py.File(path.with_suffix(".hdf")) as pack:
        count, contacts = len(pack["particles/radius"]), int(pack["particles/contacts"][:].max())
    expect(told["spheres"] == count and told["sorry"] == "", f"{name}: the view says {told}")
    whole, half, none, again = (told[which]["covered"] for which in ("whole", "half", "none", "again"))
    expect(0.08 < whole < 0.6 and 0.3 * whole < half < 0.95 * whole and none < 0.02 and again == whole, f"{name}: the view covers {told}")
    shown, turned = page.value(TURN)
    expect(shown == count and turned, f"{name}: after a drag {shown} of {count} spheres are shown, turned: {turned}")
    expect(told["whole"]["seen"] > 16, f"{name}: the view has {told['whole']['seen']} colours")
    expect(told["fields"][:3] == ["radius", "contacts", "layer of insertion"] and told["high"] == str(contacts), f"{name}: fields {told}")


def expect(condition, words):
    if not condition:
        problems.append(words)


def run(*command, codes=(0,)):
    done = subprocess.run([str(word) for word in command], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode not in codes:
        sys.exit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}")
    return done.stdout


def check_watcher(page):
    """A page that fetches and complains is seen to do so."""
    page.open("data:text/html,<img src='http://127.0.0.1:8/x.png'><script>console.error('a complaint')</script>")
    expect("http://127.0.0.1:8/x.png" in page.requests, f"a request was not seen, but {page.requests}")
    expect("a complaint" in page.complaints, f"a complaint was not seen, but {page.complaints}")


def value(text):
    """A number as the page writes it."""
    found = re.match(r"([+−]?[0-9.  ]+)(?: × 10(−?[0-9]+))?", text.replace("\xa0", " ").strip())
    if not found:
        return None
    power = int((found[2] or "0").replace("−", "-"))
    return float(found[1].replace("−", "-").replace(" ", "").replace(" ", "")) * 10.0 ** power


def check_numbers(name, rows, hdf):
    """What the pack says, found again on the page; and sizes by a plain count."""
    with h5py.File(hdf) as pack:
        radius, summary = np.sort(pack["particles/radius"][:]), dict(pack["summary"].attrs)
    achieved = {}
    part = ""
    for row in rows:
        part = row[0] if len(row) == 1 else part
        if len(row) > 1:
            words, _, unit = row[0].partition(" [")
            there = value(row[2])
            achieved[part, words] = there and there * {"": 1.0, "m]": 1.0, "mm]": 1e-3}[unit]
    mass = np.cumsum(radius ** 3) / np.sum(radius ** 3)
    wanted = {("The pack", "particles"): len(radius), ("The pack", "height"): summary["height"],
              ("The pack", "φ of the bulk"): summary["phi_bulk"],
              ("The pack", "porosity of the bulk, 1 − φ"): 1.0 - summary["phi_bulk"],
              ("The pack", "void ratio of the bulk, (1 − φ) / φ"): 1.0 / summary["phi_bulk"] - 1.0}
    for percent in (10, 30, 50, 60, 90):
        by_number = radius[int(np.ceil(percent / 100 * len(radius))) - 1]
        wanted["Diameters by number", f"D{percent}"] = 2.0 * by_number
        wanted["Diameters by mass", f"D{percent}"] = 2.0 * radius[np.argmax(mass >= percent / 100)]
    for key, right in wanted.items():
        there = achieved.get(key)
        expect(there is not None and abs(there - right) <= 1e-3 * abs(right), f"{name}: {key} is {there!r}, not {right}")


def check_page(page, path, pictures):
    name = path.stem
    page.look(1200)
    page.open(path.as_uri())
    fetched = [one for one in page.requests if not one.startswith("data:") and one != path.as_uri()]
    expect(not fetched, f"{name}: the page asks for {fetched}")
    complaints = [words for words in page.complaints if "GPU stall due to ReadPixels" not in words]   # a canvas without a GPU
    expect(not complaints, f"{name}: the page complains: {complaints}")
    if page.value("document.getElementById('view') !== null") != (name == "grading"):
        problems.append(f"{name}: a view where none is, or none")
    elif name == "grading":
        check_view(page, path)
    images = page.value(IMAGES)
    expect(len(images) == pictures, f"{name}: {len(images)} images instead of {pictures}")
    expect(all(width > 0 for _, width in images), f"{name}: not drawn: {images}")
    expect(all(words for words, _ in images), f"{name}: an image says nothing to those who cannot see it")
    check_numbers(name, page.value(ROWS), path.with_suffix(".hdf"))
    alerts = page.value("[...document.querySelectorAll('[role=alert]')].map(one => one.textContent)")
    with h5py.File(path.with_suffix(".hdf")) as pack:
        missed = ["lower than its target"] if not pack["summary"].attrs["reached"] else []
    expect(len(alerts) == len(missed) and all(words in alerts[0] for words in missed), f"{name}: warnings {alerts}, not {missed}")
    scene = page.value("document.querySelector('#provenance pre').textContent")
    with h5py.File(path.with_suffix(".hdf")) as pack:
        own = pack["provenance"].attrs["effective_input"]
    expect(scene.strip() == (own.decode() if isinstance(own, bytes) else own).strip(), f"{name}: another effective input")
    for dark in (False, True):
        for width in (1400, 390):
            page.look(width, dark=dark)
            wide = page.value("document.documentElement.scrollWidth")
            expect(wide <= width, f"{name}: {wide} pixels wide in a window of {width}")
            *contrasts, paper = page.value(CONTRAST)
            expect((paper < 0.1) == dark, f"{name}: the paper's luminance is {paper}, dark: {dark}")
            expect(min(contrasts) >= 4.5, f"{name}: contrasts {contrasts}, dark: {dark}")
            page.screenshot(path.with_suffix(f".{'dark' if dark else 'light'}.{width}.png"))


def check_plots(program, folder, name):
    """The plots alone, as files."""
    run(program, "plot", folder / f"{name}.hdf", "--only", "density", "settling", "-o", folder / "plots")
    for plot in ("density", "settling"):
        expect((folder / "plots" / f"{name}.{plot}.png").read_bytes().startswith(b"\x89PNG"), f"no plot {plot}.png")


def main():
    root, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    program = sys.argv[sys.argv.index("--") + 1:]
    if browser.program() is None:
        print("skipped: Chromium is missing (scripts/setup.sh --report)")
        return 77
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    has_vtk = subprocess.run([sys.executable, "-c", "import vtk"], capture_output=True).returncode == 0
    can_draw = {"grading": has_vtk and shutil.which("xvfb-run") is not None, "periodic_2d": True}
    for name, change in SCENES.items():
        run(*program, root / "input" / f"{name}.toml", "-o", folder, *SMALL, *change, codes=(0, 3))
        run(program[-1], "report", folder / f"{name}.hdf", "--size", 200)
    check_plots(program[-1], folder, "periodic_2d")
    with tempfile.TemporaryDirectory() as profile, browser.Browser(profile) as page:
        check_watcher(page)
        for name in SCENES:
            check_page(page, folder / f"{name}.html", (2 if can_draw[name] else 0) + (name in SECTIONS) + PLOTS[name])
    print(json.dumps(problems, indent=1, ensure_ascii=False) if problems else "two pages looked at, light and dark, wide and narrow")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
