"""What the scripts that measure packs share: scenes that leave their protocol to a preset, one analysis for the packs of any code, where and
when something was measured, and how a block of a document is written anew."""
import csv
import datetime
import os
import statistics
import subprocess
from pathlib import Path

import numpy as np

from common import ENVIRONMENT, ROOT  # noqa: F401  (for the scripts that measure)

# What a pack may differ by from the reference protocol's, at equal inserted mass.
BOUNDS = {"phi_bulk": 0.002, "coordination": 0.05, "overlap": 0.20}

# What the levels of x86-64 need beyond each other, the best first: enough to tell them apart.
INSTRUCTION_SETS = {"x86-64-v4": {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"}, "x86-64-v3": {"avx2", "fma", "bmi2"}}


# A preset of the sliding law, to where "paper" ends, which is not at rest.
SLIDING = {"contact.tangential": "sliding", "rest.wait": "0"}


def bare_scene(file, folder, more=()):
    """input/FILE.toml without its own fidelity, step and duration, so that these come from the preset that a run names: keys of
    a scene win over its preset's; and without the keys of `more`. The copy's path, in `folder`."""
    own = ("fidelity", "duration", "time_step", *more)
    lines = (ROOT / f"input/{file}.toml").read_text().splitlines()
    path = Path(folder) / f"{file}.toml"
    path.parent.mkdir(parents=True, exist_ok=True)
    fresh = path.with_suffix(f".{os.getpid()}")   # another run of the script may be reading the file
    fresh.write_text("\n".join(line for line in lines if line.split("=")[0].strip() not in own) + "\n")
    return fresh.replace(path)


def options_of(settings):
    """{"a.b": "1"} as packmpi's --set options."""
    return [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]


def touching(positions, radii):
    """Pairs (M, 2) of spheres that overlap and their overlaps over the smaller radius. No periodic images."""
    from scipy.spatial import cKDTree
    pairs = cKDTree(positions).query_pairs(2.0 * radii.max(), output_type="ndarray")
    gap = np.linalg.norm(positions[pairs[:, 0]] - positions[pairs[:, 1]], axis=1)
    overlap = radii[pairs[:, 0]] + radii[pairs[:, 1]] - gap
    pairs, overlap = pairs[overlap > 0.0], overlap[overlap > 0.0]
    return pairs, overlap / np.minimum(radii[pairs[:, 0]], radii[pairs[:, 1]])


def solid_below(level, heights, radii):
    """Volume of spheres below a level, with exact caps [m3]."""
    h = np.clip(level - heights + radii, 0.0, 2.0 * radii)
    return float(np.sum(np.pi * h * h * (3.0 * radii - h) / 3.0))


def analyse(positions, radii, side, height):
    """Solid fraction between 0.2 and 0.8 of the height, mean touching spheres, mean overlap over the smaller radius."""
    pairs, overlap = touching(positions, radii)
    low, high = (solid_below(share * height, positions[:, 2], radii) for share in (0.2, 0.8))
    return {"spheres": len(radii), "phi_bulk": (high - low) / (0.6 * height * side * side),
            "coordination": 2.0 * len(pairs) / len(radii), "overlap": float(overlap.mean())}


def read_dump(path):
    """Positions (N, 3) of a LAMMPS or LIGGGHTS dump 'id x y z' of one frame."""
    text = Path(path).read_text().split("ITEM: ATOMS")[1].split("\n", 1)[1]
    return np.array(text.split(), float).reshape(-1, 4)[:, 1:]


def read_pack(path):
    """Positions and radii of a pack file."""
    from packmpi import Pack
    pack = Pack(path)
    return pack.position, pack.radius


def commit():
    return subprocess.run(["git", "-C", ROOT, "describe", "--always", "--dirty"], text=True, capture_output=True,
                          check=False).stdout.strip() or "unknown"


def machine():
    """The CPU's model and the kernel's instruction set on it (PACKMPI_ARCH, or the best there is)."""
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    about = {line.split(":")[0].strip(): line.split(":")[1].strip() for line in lines if ":" in line}
    flags = set(about.get("flags", "").split())
    best = next((name for name, wanted in INSTRUCTION_SETS.items() if wanted <= flags), "x86-64")
    return f"{about.get('model name', 'unknown CPU')}, {os.environ.get('PACKMPI_ARCH', best)}"


def made_by(script):
    return f"Made by `{script}` on {datetime.date.today()}, commit {commit()}, {machine()}"


def spread(values, digits=1, scale=1.0):
    """Median (least to most)."""
    values = sorted(v * scale for v in values)
    if len(values) == 1:
        return f"{values[0]:.{digits}f}"
    return f"{statistics.median(values):.{digits}f} ({values[0]:.{digits}f} to {values[-1]:.{digits}f})"


def write_csv(path, columns, rows):
    """A table of the documentation's data: a line a row, empty where a row has no such column."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fieldnames=columns, lineterminator="\n", restval="")
        writer.writeheader()
        writer.writerows(rows)


def study_options(parser, name, page):
    """Adds what scripts have that make packs for one page, and reads the command line: program, results and document as paths, set as words of `packmpi`."""
    parser.add_argument("--program", type=lambda text: Path(text).resolve(), default=ROOT / "build/packmpi")
    parser.add_argument("--results", type=lambda text: Path(text).resolve(), default=ROOT / "results" / name)
    parser.add_argument("--document", type=Path, default=ROOT / "doc" / page)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="change the scenes (tests)")
    options = parser.parse_args()
    options.set = [word for value in options.set for word in ("--set", value)]
    return options


def write_block(document, name, text):
    """Replaces what stands between the document's two markers of that name."""
    begin, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
    document = Path(document)
    head, rest = document.read_text().split(begin)
    document.write_text(f"{head}{begin}\n{text}\n{end}{rest.split(end)[1]}")
