"""Colours of all pictures and plots, and how plots look."""
from typing import Any

INK = "#222222"
BACKGROUND = "#ffffff"
GRID = "#e5e5e5"
TARGET = "#d1495b"
ACHIEVED = "#00798c"
OTHER = "#8d99ae"
LID = "#30638e"

# matplotlib's rcParams
LOOK: dict[str, Any] = {
    "font.size": 9.5, "axes.edgecolor": INK, "axes.labelcolor": INK, "text.color": INK, "xtick.color": INK,
    "ytick.color": INK, "axes.grid": True, "grid.color": GRID, "grid.linewidth": 0.7, "axes.axisbelow": True,
    "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False, "legend.fontsize": 8.5,
    "lines.linewidth": 1.6, "figure.facecolor": BACKGROUND, "axes.facecolor": "none", "svg.hashsalt": "packmpi"}
