"""The readings that scripts/study/readings.py tries, and their table in doc/reproduction.md."""
import csv
import math
import re
from dataclasses import dataclass

import reproduction_report as tables

BEGIN, END = "<!-- readings: begin -->", "<!-- readings: end -->"
TARGET = 0.5   # [m] H_d of all examples
COLUMNS = [(example, rotation) for example in tables.TITLES for rotation in ("on", "off")]
FLAT = [column for column in COLUMNS if column[0] in ("5.1", "5.2")]
SPACE = [column for column in COLUMNS if column not in FLAT]
SHOWN = 20          # readings in the table


@dataclass(frozen=True)
class Way:
    """Where a layer's region begins, as scripts/study/readings.cpp is told."""
    name: str
    start: str       # FROM
    shift: float     # [mean diameters] SHIFT
    share: str       # OF
    words: str

    @property
    def arguments(self):
        return [self.start, f"{self.shift:g}", self.share]


WAYS = [
    Way("highest", "highest", 0.0, "region", "the highest top"),
    Way("surface", "surface", 0.0, "region", "the mean surface"),
    Way("centres", "surface", -0.5, "region", "the mean of the highest centres"),
    Way("tenth", "tenth", 0.0, "region", "the highest tenth of the surface"),
    Way("holes", "surface", -1.5, "region", "1.5 d below the mean surface"),
    Way("surface-of-centres", "surface", 0.0, "centres", "the mean surface; phi_0 of the region of centres"),
    Way("highest-of-centres", "highest", 0.0, "centres", "the highest top; phi_0 of the region of centres"),
]
ENDS = ("container", "whole", "open")

# What ends the loop: the end of a run, the words, and the first layer that is one too many or the last one (none).
STOPS = {
    "no room": ("container", "at H_d; no room for a sphere", None),
    "filled": ("whole", "at H_d, whole layers as far as they fit; no room for a sphere", None),
    "no layer": ("trunk", "open; no room for a whole region below H_d", None),
    "highest": ("open", "open; highest top ≥ H_d", lambda row, target: row["highest"] >= target),
    "surface": ("open", "open; mean surface ≥ H_d", lambda row, target: row["surface"] >= target),
    "tenth": ("open", "open; highest tenth ≥ H_d", lambda row, target: row["tenth"] >= target),
}
UNFINISHED = "unfinished"   # rows of a run that was cut short, with the last layer that it has
VOLUMES = {"phi": "H_d", "phi_surface": "its mean surface", "phi_highest": "its highest top"}


def last_layer(layers, stop, target):
    """The layer after which this rule ends a run; None if the run does not tell."""
    end, _, over = STOPS[stop]
    trunk = [row for row in layers if row["end"] == "trunk"]
    rest = [row for row in layers if row["end"] == end]
    if end == "trunk":
        return trunk[-1] if trunk else None
    if over is None:
        return rest[-1] if rest else None
    return next((row for row in trunk + rest if over(row, target)), None)


def packs_of(runs):
    """Rows of doc/data/readings.csv: each run, of which its layers are given, under each rule that ends it."""
    rows = []
    for run, layers in runs:
        done = run.file.exists()
        for stop in STOPS if done else [UNFINISHED]:
            last = last_layer(layers, stop, TARGET) if done else layers[-1]
            if last is not None:
                rows.append({"way": run.way.name, "stop": stop, "example": run.example, "rotation": run.rotation, "seed": run.seed,
                             **{key: last[key] for key in ("layer", "particles", "highest", "surface", *VOLUMES)}})
    return rows


class Reading:
    """One reading of the method: its packs in each of the eight columns."""

    def __init__(self, way, stop, volume, packs, paper, bounds):
        self.way, self.stop, self.volume, self.packs, self.paper = way, stop, volume, packs, paper
        self.bounds = bounds   # of columns without packs: a fraction that the bed passes already before its last layers

    def values(self, column):
        return [float(row[self.volume]) for row in self.packs.get(column, [])]

    def off(self, column):
        """Distance of the means, in the paper's standard deviations."""
        return (tables.mean(self.values(column)) - tables.mean(self.paper[column])) / tables.sd(self.paper[column])

    def least_off(self, column):
        """The same of a bound."""
        return (self.bounds[column] - tables.mean(self.paper[column])) / tables.sd(self.paper[column])

    @property
    def measured(self):
        return [column for column in COLUMNS if self.values(column)]

    @property
    def met(self):
        return sum(abs(self.off(column)) <= tables.PAPER_SDS for column in self.measured)

    @property
    def excluded(self):
        """Is a column off by more than so few packs could be by chance, even if they vary as the paper's do?"""
        return any(abs(self.off(column)) > tables.PAPER_SDS * (1.0 + 1.0 / math.sqrt(len(self.values(column)))) for column in self.measured) or \
            any(self.least_off(column) > 2.0 * tables.PAPER_SDS for column in self.bounds)

    @property
    def worst(self):
        return max(abs(self.off(column)) for column in self.measured)

    @property
    def score(self):
        return math.sqrt(tables.mean([self.off(column) ** 2 for column in self.measured]))

    def count(self, examples):
        counts = [float(row["particles"]) for column in self.measured if column[0] in examples for row in self.packs[column]]
        return f"{min(counts):.0f} to {max(counts):.0f}" if counts else ""


PROGRAMS = ("packmpi", "", "i")  # whose packs count, if there are of several: packmpi, readings.cpp, the independent program


def rows_of(data):
    """Packs of readings.cpp; of packmpi itself, under its own reading, instead; of the independent program, beside."""
    rows = [{**row, "program": ""} for row in tables.read(data / "readings.csv")]
    own = [{**row, "way": "highest", "stop": "surface", "program": "packmpi"} for row in tables.read(data / "reproduction.csv")]
    other = [{**row, "program": "i"} for row in tables.read(data / "readings_independent.csv")]
    return rows + own + other


def readings_of(rows, paper):
    """All readings of which there is any pack."""
    found = []
    for way in WAYS:
        for stop in STOPS:
            for volume in VOLUMES:
                packs = {}
                for row in rows:
                    if (row["way"], row["stop"]) == (way.name, stop) and row.get(volume):
                        packs.setdefault((row["example"], row["rotation"]), []).append(row)
                for column, all_packs in packs.items():   # of one program: packmpi's are ten, the independent one's two
                    kept = min((row["program"] for row in all_packs), key=PROGRAMS.index)
                    packs[column] = [row for row in all_packs if row["program"] == kept]
                bounds = {(row["example"], row["rotation"]): float(row[volume]) for row in rows
                          if (row["way"], row["stop"], volume) == (way.name, UNFINISHED, "phi_surface")}
                if packs:
                    found.append(Reading(way, stop, volume, packs, paper, {c: bounds[c] for c in bounds if c not in packs}))
    return found


def cell(reading, column):
    values = reading.values(column)
    if not values and column in reading.bounds:
        mark = "" if reading.least_off(column) <= tables.PAPER_SDS else "**"
        return f"{mark}> {reading.bounds[column]:.3f}{mark}"
    if not values:
        return ""
    mark = "" if abs(reading.off(column)) <= tables.PAPER_SDS else "**"
    note = ", i" if reading.packs[column][0]["program"] == "i" else ""
    return f"{mark}{tables.of_sample(values)}{mark} ({len(values)}{note})"


def table_of(readings):
    heads = ["begins at", "ends", "V to", *(f"{example} {rotation}" for example, rotation in COLUMNS), "discs", "spheres",
             "within 2 sd", "rms", "worst"]
    paper = readings[0].paper
    rows = [["**the paper**", "", "", *(tables.of_sample(paper[column]) for column in COLUMNS), "1300", "7500 to 8000", "", "", ""]]
    for one in readings:
        rows.append([one.way.words, STOPS[one.stop][1], VOLUMES[one.volume], *(cell(one, column) for column in COLUMNS),
                     one.count(("5.1", "5.2")), one.count(("5.3", "5.4")), f"{one.met} of {len(one.measured)}",
                     f"{one.score:.1f}", f"{one.worst:.1f}"])
    return tables.table(heads, rows)


def meets(reading, columns):
    """Is every one of these columns run and within the bounds?"""
    return all(reading.values(column) and abs(reading.off(column)) <= tables.PAPER_SDS for column in columns)


def seeds_of(readings, columns):
    """How many seeds the columns of the ways to insert have, in words."""
    counts = sorted({len(one.values(column)) for one in readings for column in columns
                     if one.values(column) and one.packs[column][0]["program"] == ""})
    return f"{counts[0]}" if len(counts) == 1 else f"{counts[0]} to {counts[-1]}"


def section(data):
    """The lines of doc/reproduction.md between its markers, and they; none without doc/data/readings.csv."""
    if not (data / "readings.csv").exists():
        return []
    paper = {column: [] for column in COLUMNS}
    for row in tables.read(data / "paper_tables.csv"):
        paper[row["example"], row["rotation"]].append(float(row["phi"]))
    readings = readings_of(rows_of(data), paper)
    readings.sort(key=lambda one: (-len(one.measured), one.excluded, one.score))
    meeting = [one for one in readings if one.met == len(COLUMNS)]
    excluded = [one for one in readings if one.excluded]
    flat = [one for one in readings if meets(one, FLAT)]
    nearest = min((one for one in flat if set(SPACE) <= set(one.measured)), key=lambda one: max(abs(one.off(c)) for c in SPACE))
    farthest = max(SPACE, key=lambda column: abs(nearest.off(column)))
    best = min((one for one in readings if len(one.measured) == len(COLUMNS)), key=lambda one: one.score)
    missed = max(COLUMNS, key=lambda column: abs(best.off(column)))
    scatters = sorted(tables.sd(one.values(c)) for one in readings for c in SPACE if len(one.values(c)) > 1)
    words = f"""The paper's Algorithm 1 leaves open where a layer's region begins, whether it ends at H_d, when the loop stops, and what V in eq. (22)
is. `scripts/study/readings.py` tries them. {len(readings)} readings: **{len(meeting) or "none"} meets all eight columns within 2 sd**; {len(excluded)} are excluded, having a column that is off by more than
2 + 2 / sqrt(packs) sd, the others by less. {packs_a_column(readings)} {len(flat)} meet the four columns in 2D (seeds: {seeds_of(readings, FLAT)}); of them the nearest in 3D (seeds: {seeds_of(readings, SPACE)}) begins at {nearest.way.words}, is
{STOPS[nearest.stop][1]}, V to {VOLUMES[nearest.volume]}, and has {tables.mean(nearest.values(farthest)):.3f} where the paper has {tables.mean(nearest.paper[farthest]):.3f} in {farthest[0]} with rotation {farthest[1]}: {abs(nearest.off(farthest)):.0f} of the paper's sd.
**Nearest of all** by the mean square of the eight means: begins at {best.way.words}, {STOPS[best.stop][1]}, V to {VOLUMES[best.volume]}; {best.met} of 8 columns
within 2 sd, rms {best.score:.1f}, and at worst {tables.mean(best.values(missed)):.3f} where the paper has {tables.mean(best.paper[missed]):.3f} ({missed[0]}, rotation {missed[1]}: {abs(best.off(missed)):.1f} sd); it inserts {best.count(("5.1", "5.2"))}
discs (the paper: typically 1300) and {best.count(("5.3", "5.4"))} spheres (typically 7500 to 8000). Seeds of one
reading vary by {scatters[len(scatters) // 2]:.4f} in 3D (the median of {len(scatters)} standard deviations of two seeds or more), and by {scatters[-1]:.3f} at most, where one layer more or less hangs on the highest sphere. Below are the {SHOWN} nearest:
the number of packs in brackets, **bold** what is off by more than 2 sd; rms and worst are the distances of the means in the paper's standard deviations. "Discs" and
"spheres" are particles inserted, from the least to the most. The row of all eight columns is packmpi as it is; "i" is an independent serial program
([data/readings_independent.csv](data/readings_independent.csv)); ">" is from a run that was cut short: with V up to the surface phi rises layer by layer, and it had that
already. Packs: [data/readings.csv](data/readings.csv). "The highest top", "at H_d", V to H_d is `layers.region = "container"`.""".splitlines()
    return [BEGIN, *words, "", *table_of(readings[:SHOWN]), END]


def packs_a_column(readings):
    """How many packs a column of a reading has, in words."""
    counts = [len(one.values(column)) for one in readings for column in COLUMNS]
    least, most = min(counts), max(counts)
    if least == most:
        return f"Each reading has {least} packs of each of the eight columns."
    return f"A column of a reading has {least} to {most} packs."


def chapter(data):
    """The chapter of doc/reproduction.md on readings; none without doc/data/readings.csv."""
    lines = section(data)
    return ["## Readings of the method", "", *lines, ""] if lines else []


def merged(kept, made):
    """Rows of doc/data/readings.csv that are kept, those of packs that were made anew replaced, in the order of WAYS."""
    def pack(row):
        return row["way"], row["example"], row["rotation"], int(row["seed"])

    anew = {pack(row) for row in made}
    order = {way.name: number for number, way in enumerate(WAYS)}
    rows = [row for row in kept if pack(row) not in anew] + made
    return sorted(rows, key=lambda row: (order[row["way"]], *pack(row)[1:]))


def write(doc, runs):
    """Adds runs, if there are any, to doc/data/readings.csv, and the table to doc/reproduction.md."""
    made, file_of_packs = packs_of(runs), doc / "data" / "readings.csv"
    if made:
        rows = merged(tables.read(file_of_packs) if file_of_packs.exists() else [], made)
        with open(file_of_packs, "w", newline="") as file:
            writer = csv.DictWriter(file, fieldnames=list(made[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
    page = doc / "reproduction.md"
    lines = section(doc / "data")
    page.write_text(re.sub(f"{BEGIN}.*{END}", lambda _: "\n".join(lines), page.read_text(), flags=re.DOTALL))
    print("\n".join(lines))
