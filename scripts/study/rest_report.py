"""The report of rest.py: tables in doc/rest.md and the plot, from the rows of doc/data/rest.csv."""
import math
import statistics

import measuring
from packmpi.style import ACHIEVED, INK, LOOK, OTHER, TARGET

# Serial code of ours, one seed each (+- .003 in phi_bulk): 3D, r .02, walls, floor .5 x .5, layers of 1 s.
INDEPENDENT = {0.001: (0.615, 5.15), 0.1: (0.598, 5.05), 0.2: (0.587, 4.78), 0.5: (0.564, 4.49), 1.0: (0.560, 4.30), 10.0: (0.568, 4.19)}
# Friction, solid fraction from .. to, contacts of a sphere that is no rattler from .. to, source.
PUBLISHED = [(0.001, (0.637, 0.647), (5.9, 6.1), "Agnolin & Roux 2007; Silbert 2010"),
             (0.3, (0.593, 0.593), (4.5, 4.5), "Agnolin & Roux 2007, compressed"),
             (10.0, (0.55, 0.57), (3.8, 4.2), "Silbert 2010; Jerkins et al. 2008")]
BOUNDS = {"phi_bulk": 0.003, "coordination": 0.05}


def chosen(rows, **wanted):
    return [row for row in rows if all(str(row[key]) == str(value) for key, value in wanted.items())]


def mean(rows, key):
    return statistics.mean(float(row[key]) for row in rows)


def error(rows, key):
    """Standard error of the mean, nan for one row."""
    return statistics.stdev(float(row[key]) for row in rows) / math.sqrt(len(rows)) if len(rows) > 1 else math.nan


def with_error(rows, key, digits):
    if not rows:
        return ""
    return f"{mean(rows, key):.{digits}f}" + (f" +- {error(rows, key):.{digits}f}" if len(rows) > 1 else "")


def held(mu):
    """The core whose complement are the rattlers: a sphere without friction needs dimension + 1 contacts, one with it three."""
    return 4 if mu < 0.01 else 3


def frictions(rows):
    return sorted({(float(row["mu"]), row["rolling"]) for row in rows}, key=lambda point: (float(point[1]) > 0.0, point[0]))


def name_of(mu, rolling):
    return f"{mu:g}" + (f", rolling and twisting {rolling}" if float(rolling) else "")


def curve_table(rows):
    out = ["| friction | phi_bulk | Z of all | z of the bulk | z without rattlers | rattlers | overlap / r | KE / (m g d) |", "|---|---|---|---|---|---|---|---|"]
    for mu, rolling in frictions(chosen(rows, part="curve")):
        some, least = chosen(rows, part="curve", mu=mu, rolling=rolling), held(mu)
        out.append(f"| {name_of(mu, rolling)} | {with_error(some, 'phi_bulk', 4)} | {with_error(some, 'coordination', 3)} | "
                   f"{with_error(some, 'coordination_bulk', 3)} | {with_error(some, f'core_{least}', 3)} | {100.0 * mean(some, f'outside_{least}'):.1f} % | "
                   f"{mean(some, 'overlap'):.1e} | {max(float(row['kinetic']) for row in some):.0e} |")
    return out


def beside_table(rows):
    out = ["| friction | code | phi_bulk | difference | Z of all | difference | KE / (m g d) | CPU s |", "|---|---|---|---|---|---|---|---|"]
    for mu, rolling in frictions(chosen(rows, part="lammps")):
        for part, code in (("curve", "packmpi"), ("lammps", "LAMMPS"), ("serial", "serial")):
            some = chosen(rows, part=part, mu=mu, rolling=rolling)
            if some:
                out.append(f"| {name_of(mu, rolling)} | {code} ({len(some)}) | {with_error(some, 'phi_bulk', 4)} | {difference(rows, some, 'phi_bulk', 4)} | "
                           f"{with_error(some, 'coordination', 3)} | {difference(rows, some, 'coordination', 3)} | "
                           f"{max(float(row['kinetic']) for row in some):.0e} | {mean(some, 'cpu_seconds'):.0f} |")
    return out


def difference(rows, some, key, digits):
    """Of packmpi from these rows, seed by seed, with its standard error."""
    pairs = [(own, row) for row in some for own in chosen(rows, part="curve", mu=row["mu"], rolling=row["rolling"], seed=row["seed"])]
    if some[0]["code"] == "packmpi" or not pairs:
        return ""
    values = [float(own[key]) - float(row[key]) for own, row in pairs]
    spread = f" +- {statistics.stdev(values) / math.sqrt(len(values)):.{digits}f}" if len(values) > 1 else ""
    return f"{statistics.mean(values):+.{digits}f}{spread}" + (" **out of bounds**" if abs(statistics.mean(values)) > BOUNDS[key] else "")


def stiffness_table(rows):
    out = ["| friction | E [Pa] | mean overlap / r | phi_bulk | z without rattlers |", "|---|---|---|---|---|"]
    for mu in sorted({float(row["mu"]) for row in chosen(rows, part="stiffness")}):
        same = chosen(rows, part="stiffness", mu=mu) + chosen(rows, part="curve", mu=mu, rolling="0")
        points = []
        for modulus in sorted({row["modulus"] for row in same}, key=float):
            some, key = chosen(same, modulus=modulus), f"core_{held(mu)}"
            points.append((math.sqrt(mean(some, "overlap")), mean(some, "phi_bulk"), mean(some, key)))
            out.append(f"| {mu:g} | {modulus} | {mean(some, 'overlap'):.2e} | {with_error(some, 'phi_bulk', 4)} | {with_error(some, key, 3)} |")
        if len(points) > 1:
            out.append(f"| {mu:g} | rigid | 0, by z linear in the root of the overlap | | {at_zero([(x, z) for x, _, z in points]):.2f} |")
    return out


def at_zero(points):
    """Value at x = 0 of the straight line through points by least squares."""
    x, y = (statistics.mean(values) for values in zip(*points))
    slope = sum((a - x) * (b - y) for a, b in points) / sum((a - x) ** 2 for a, _ in points)
    return y - slope * x


def layers_table(rows):
    out = ["| friction | phi_bulk, elsewhere | packmpi | Z, elsewhere | packmpi |", "|---|---|---|---|---|"]
    for mu, (phi, contacts) in INDEPENDENT.items():
        some = chosen(rows, part="layers", mu=mu)
        out.append(f"| {mu:g} | {phi} | {with_error(some, 'phi_bulk', 4)} | {contacts} | {with_error(some, 'coordination', 3)} |")
    return out


def published_table():
    out = ["| friction | phi | z without rattlers | source |", "|---|---|---|---|"]
    for mu, phi, contacts, source in PUBLISHED:
        out.append("| " + " | ".join([f"{mu:g}", *(f"{low:g}" if low == high else f"{low:g} to {high:g}" for low, high in (phi, contacts)), source]) + " |")
    return out


def plot(path, rows):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt
    plt.rcParams.update(LOOK)
    figure, both = plt.subplots(2, 1, figsize=(5.6, 6.0), layout="constrained", sharex=True)
    for axes, key, place in zip(both, ("phi_bulk", "coordination_bulk"), (1, 2)):
        for k, published in enumerate(PUBLISHED):
            low, high = published[place]
            axes.fill_between([published[0] / 1.6, published[0] * 1.6], low, max(high, low + (0.0015 if place == 1 else 0.04)), color=TARGET, alpha=0.28,
                              linewidth=0, label="published" if k == 0 else None)
        for part, label, style in (("curve", "packmpi", {"color": ACHIEVED, "fmt": "o-", "markersize": 3.5}),
                                   ("lammps", "LAMMPS, same start", {"color": INK, "fmt": "s", "markerfacecolor": "none", "markersize": 8}),
                                   ("serial", "serial program, same start", {"color": OTHER, "fmt": "x", "markersize": 6})):
            for rolling in ("0", "0.2"):
                points = [point for point in frictions(chosen(rows, part=part)) if point[1] == rolling]
                groups = [chosen(rows, part=part, mu=mu, rolling=rolling) for mu, _ in points]
                if groups:
                    axes.errorbar([mu for mu, _ in points], [mean(group, key) for group in groups],
                                  [error(group, key) if len(group) > 1 else 0.0 for group in groups], label=label if rolling == "0" else None, **style)
        rough = chosen(rows, part="curve", rolling="0.2")
        if rough:
            axes.annotate("rolling, twisting 0.2", (float(rough[0]["mu"]), mean(rough, key)), (6, -4), textcoords="offset points", fontsize=8)
        axes.set(xscale="log", ylabel={"phi_bulk": r"solid fraction $\phi_\mathrm{bulk}$", "coordination_bulk": "contacts of a sphere"}[key])
    both[1].set_xlabel(r"friction $\mu$")
    both[0].legend(fontsize=8)
    figure.savefig(path, metadata={"Date": None})


def write(doc, rows):
    """Blocks of doc/rest.md and doc/images/rest.svg."""
    plot(doc / "images/rest.svg", rows)
    made = measuring.made_by("scripts/study/rest.py")
    blocks = {"rest-curve": curve_table(rows), "rest-beside": beside_table(rows), "rest-stiffness": stiffness_table(rows), "rest-layers": layers_table(rows),
              "rest-published": published_table()}
    absent = {"rest-stiffness": "stiffness", "rest-layers": "layers"}
    for name, table in blocks.items():
        if name in absent and not chosen(rows, part=absent[name]):
            continue   # the page says that it was not run
        print("\n".join(table), end="\n\n")
        if (doc / "rest.md").exists():
            measuring.write_block(doc / "rest.md", name, "\n".join([f"{made}.", "", *table]))
