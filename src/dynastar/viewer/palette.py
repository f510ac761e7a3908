"""One set of colours for every picture, safe for colour-blind readers and in grey print.

Planning is blue, movers are green (both from [Okabe2008]), what was driven runs from dark violet
(standing) to orange (fast), and what stands is grey: dark where mapped, lighter where not.
"""

import matplotlib
from matplotlib.colors import Colormap, LinearSegmentedColormap

FREE = "#ffffff"
UNKNOWN = "#e2e4e7"
OCCUPIED = "#30343b"
KEEPOUT = "#f6dcc6"
SLOW = "#faf3cf"

EXPLORED = "#dbe9f7"
EXPLORED_EDGE = "#8fb6dc"
FIRST_PATH = "#0a3d8f"
LATER_PATHS = ("#1f78c8", "#5ab4e5")

OBSTACLE = "#b4b7bd"
OBSTACLE_EDGE = "#4c5058"
MOVER = "#009e73"
MOVER_EDGE = "#00614a"

DRIVEN = "#c43c4e"
ROBOT = "#4a1460"
CONTACT = "#e3001b"

INK = "#22252b"
FAINT_INK = "#6b7079"


def speed_colours() -> Colormap:
    """Speed to colour: the middle of "inferno", without its black and its yellow."""
    whole = matplotlib.colormaps["inferno"]
    shades = [whole(0.22 + 0.58 * i / 63) for i in range(64)]
    return LinearSegmentedColormap.from_list("speed", shades)


def later_path(index: int, count: int) -> tuple[float, float, float, float]:
    """The blue of the ``index``-th (from 0) of ``count`` plans after the first."""
    shades = LinearSegmentedColormap.from_list("later", LATER_PATHS)
    return shades(index / max(count - 1, 1))
