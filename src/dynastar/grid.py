"""The grid model (section II, Eq. 1, Fig. 1): cells, their states, and where they are."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from numbers import Integral, Real
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeVar, get_args

import numpy as np
import numpy.typing as npt

from dynastar.config import shown, summary
from dynastar.errors import ConfigError, MapError, OutOfMap
from dynastar.extras import plotter
from dynastar.geometry import length, place

if TYPE_CHECKING:  # Matplotlib comes with an extra
    from matplotlib.axes import Axes

FREE, OCCUPIED, UNKNOWN = 0, 100, -1
OCCUPIED_FROM, FREE_TO = 65, 19  # of 100, as map_server's 0.65 and 0.196
MAX_CELLS = 16384 * 16384  # of a map, 268 million

Unknown = Literal["free", "blocked"]
Mask = npt.NDArray[np.bool_]
Cell = TypeVar("Cell", bound=np.generic)


class GridFrame(NamedTuple):
    """Where a grid lies: size of a cell (m) and pose of the corner of cell [0, 0] (m, rad)."""

    resolution: float
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0

    def to_grid(self, x: float, y: float) -> tuple[float, float]:
        """(row, column) of a world point in cells and fractions; [r, c] is [r, r+1) x [c, c+1)."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        dx, dy = x - self.x, y - self.y
        return (-sin * dx + cos * dy) / self.resolution, (cos * dx + sin * dy) / self.resolution

    def to_world(self, row: float, column: float) -> tuple[float, float]:
        """World point (x, y) in metres of a (row, column) in fractions of cells."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        gx, gy = column * self.resolution, row * self.resolution
        return self.x + cos * gx - sin * gy, self.y + sin * gx + cos * gy

    def points_to_grid(self, points: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """``to_grid`` for an (n, 2) array of (x, y); returns (n, 2) of (row, column)."""
        offset = np.asarray(points, dtype=np.float64).reshape(-1, 2) - (self.x, self.y)
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        gx = cos * offset[:, 0] + sin * offset[:, 1]
        gy = -sin * offset[:, 0] + cos * offset[:, 1]
        return np.column_stack([gy, gx]) / self.resolution

    def aligned(self) -> "GridFrame":
        """This frame turned with the world about the world's origin so that the yaw is 0."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        x, y = cos * self.x + sin * self.y, cos * self.y - sin * self.x
        return GridFrame(self.resolution, x, y)

    def points_to_world(self, cells: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """``to_world`` for an (n, 2) array of (row, column); returns (n, 2) of (x, y)."""
        at = np.asarray(cells, dtype=np.float64).reshape(-1, 2) * self.resolution
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        return np.column_stack(
            [self.x + cos * at[:, 1] - sin * at[:, 0], self.y + sin * at[:, 1] + cos * at[:, 0]]
        )


_UNIT_FRAME = GridFrame(1.0)
MOST_DRAWN = 2**26  # cells of a map drawn in text
_MEANING = np.full(128, FREE, dtype=np.int8)  # of a mark
_MEANING[[ord("#"), ord("?")]] = OCCUPIED, UNKNOWN


@dataclass(frozen=True, eq=False)
class OccupancyGrid:
    """A map: ``values`` int8 [rows, columns], row 0 at the lowest y, as ROS has it.

    -1 is unknown, 0 free, 100 occupied; from 65 on counts as occupied, up to 19 as free, between
    as unknown. ``keepout`` (bool) marks cells the robot may not enter though nothing stands there;
    ``speed_limit`` (float32, m/s, inf for none) caps the speed; both are [rows, columns] or None.
    A number as ``frame`` is the side of a cell in metres.
    """

    values: npt.NDArray[np.int8]
    frame: GridFrame
    keepout: Mask | None
    speed_limit: npt.NDArray[np.float32] | None

    def __init__(
        self,
        values: npt.ArrayLike,
        frame: GridFrame | float = _UNIT_FRAME,
        keepout: npt.ArrayLike | None = None,
        speed_limit: npt.ArrayLike | None = None,
    ) -> None:
        values = _array(values, "a grid")
        if values.ndim != 2 or 0 in values.shape:
            raise MapError(f"a grid has shape {values.shape}: expected (rows, columns), both > 0")
        if values.dtype == np.bool_:
            values = np.where(values, OCCUPIED, FREE)
        if not np.issubdtype(values.dtype, np.integer) or values.min() < -1 or values.max() > 100:
            raise MapError("a grid's values have to be integers from -1 to 100, or booleans")
        frame = _framed(frame)
        object.__setattr__(self, "values", _readonly(values, np.int8))
        object.__setattr__(self, "frame", frame)
        masks = ("keepout", keepout, np.bool_), ("speed_limit", speed_limit, np.float32)
        for name, mask, dtype in masks:
            if mask is not None:
                mask = _array(mask, name, dtype)
                if mask.shape != values.shape:
                    raise MapError(
                        f"{name} has shape {mask.shape}: expected the grid's {values.shape}"
                    )
            object.__setattr__(self, name, None if mask is None else _readonly(mask, dtype))
        if self.speed_limit is not None and not (self.speed_limit > 0).all():
            raise MapError("a speed limit has to be > 0 m/s; use keepout where nothing may drive")

    def __repr__(self) -> str:
        occupied, unknown = self.occupied.mean(), self.unknown.mean()
        return summary(
            self,
            self.size(),
            self.extent(),
            f"{occupied:.1%} occupied, {unknown:.1%} unknown",
            "" if self.keepout is None else f"{self.keepout.mean():.1%} keep-out",
            "" if self.speed_limit is None else f"{self.speed_limit.min():g} m/s at the slowest",
        )

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw the map, in metres, into ``ax`` or new Matplotlib axes, and return them.

        Raises MissingPackage without Matplotlib.
        """
        return plotter("plot_grid")(self, ax)

    @staticmethod
    def from_occupied(
        occupied: npt.ArrayLike, resolution: float = 1.0, x: float = 0.0, y: float = 0.0
    ) -> "OccupancyGrid":
        """A grid without unknown cells from a [rows, columns] array that is true where occupied."""
        return OccupancyGrid(_array(occupied, "a grid", np.bool_), GridFrame(resolution, x, y))

    @staticmethod
    def from_text(
        text: str | Sequence[str], resolution: float = 1.0, x: float = 0.0, y: float = 0.0
    ) -> "OccupancyGrid":
        """A grid drawn as text, top row first: ``#`` occupied, ``.``, space free, ``?`` unknown.

        Short lines are free at their ends. Raises MapError for other marks, and for more than
        ``MOST_DRAWN`` cells.
        """
        if not isinstance(text, str | Sequence):
            raise MapError(f"a drawn map is {shown(text)}: expected a string, or one for each line")
        lines = text.strip("\n").split("\n") if isinstance(text, str) else list(text)
        legal = set("#. ?")
        for number, line in enumerate(lines, 1):
            if not isinstance(line, str):
                raise MapError(f"line {number} of a drawn map is {shown(line)}: expected a string")
            if not set(line) <= legal:
                column, mark = next((c, m) for c, m in enumerate(line, 1) if m not in legal)
                raise MapError(
                    f"line {number}, column {column} of a drawn map is {mark!r}: "
                    "expected '#', '.', ' ' or '?'"
                )
        width = max(map(len, lines), default=0)
        if len(lines) * width > MOST_DRAWN:
            raise MapError(
                f"a drawn map of {len(lines)} lines, the longest of {width} marks, has more than "
                f"{MOST_DRAWN} cells: expected an image (.yaml with .pgm or .png) instead"
            )
        drawn = "".join(line.ljust(width) for line in reversed(lines)).encode("ascii")
        marks = np.frombuffer(drawn, dtype=np.uint8).reshape(len(lines), width)
        return OccupancyGrid(_MEANING[marks], GridFrame(resolution, x, y))

    @property
    def rows(self) -> int:
        """Number of rows."""
        return int(self.values.shape[0])

    @property
    def columns(self) -> int:
        """Number of columns."""
        return int(self.values.shape[1])

    @property
    def resolution(self) -> float:
        """Side of a cell in metres (``a`` in Eq. 1)."""
        return self.frame.resolution

    @property
    def occupied(self) -> Mask:
        """Where something stands."""
        return self.values >= OCCUPIED_FROM

    @property
    def unknown(self) -> Mask:
        """Where the map does not say."""
        return (self.values < 0) | ((self.values > FREE_TO) & (self.values < OCCUPIED_FROM))

    def blocked(self, unknown: Unknown = "blocked") -> Mask:
        """Where the robot may not be: occupied, keep-out and, by policy, unknown cells."""
        if unknown not in get_args(Unknown):
            raise ConfigError(f"unknown space is {unknown!r}: expected 'free' or 'blocked'")
        blocked = self.occupied
        if unknown == "blocked":
            blocked = blocked | self.unknown
        return blocked if self.keepout is None else blocked | self.keepout

    def contains(self, x: float, y: float) -> bool:
        """Whether a world point lies on the map."""
        row, column = self.frame.to_grid(x, y)
        return 0 <= row < self.rows and 0 <= column < self.columns

    def world_to_cell(self, x: float, y: float) -> tuple[int, int]:
        """(row, column) of the cell that holds a world point; OutOfMap if none does."""
        row, column = self.frame.to_grid(x, y)
        if not (0 <= row < self.rows and 0 <= column < self.columns):
            raise OutOfMap(f"{place(x, y, 6)} is off the map, which spans {self.extent()}")
        return int(row), int(column)

    def cell_to_world(self, row: int, column: int) -> tuple[float, float]:
        """World point (x, y) of a cell's centre."""
        self._in_bounds(row, column)
        return self.frame.to_world(row + 0.5, column + 0.5)

    def number(self, row: int, column: int) -> int:
        """The paper's number of a cell: i from 1, row by row from the top left (Eq. 1)."""
        self._in_bounds(row, column)
        return (self.rows - 1 - row) * self.columns + column + 1

    def numbered(self, i: int) -> tuple[int, int]:
        """(row, column) of the paper's cell ``i`` (Eq. 1)."""
        if not isinstance(i, Integral):
            raise MapError(f"a cell's number is {shown(i)}: expected a whole number")
        if not 1 <= i <= self.rows * self.columns:
            raise OutOfMap(f"cell {i} is off the map: expected 1 to {self.rows * self.columns}")
        return self.rows - math.ceil(i / self.columns), (i - 1) % self.columns

    def centre(self, i: int) -> tuple[float, float]:
        """(x_i, y_i) of Eq. 1, metres from the map's own corner.

        x = a (mod(i - 1, columns) + 1/2), y = a (rows - ceil(i / columns) + 1/2).
        """
        row, column = self.numbered(i)
        return self.resolution * (column + 0.5), self.resolution * (row + 0.5)

    def size(self) -> str:
        """In words, how many cells the map has, and how large they are."""
        return f"{self.columns} x {self.rows} cells of {self.resolution:g} m"

    def extent(self) -> str:
        """In words, which stretch of the world the map covers."""
        far = np.array([[0, 0], [0, self.columns], [self.rows, 0], [self.rows, self.columns]])
        low = self.frame.points_to_world(far).min(axis=0)
        high = self.frame.points_to_world(far).max(axis=0)
        return "x {} to {}, y {} to {} m".format(*map(length, np.column_stack([low, high]).ravel()))

    def refined(self, factor: int) -> "OccupancyGrid":
        """The same map with every cell cut into ``factor`` x ``factor``."""
        if not isinstance(factor, Integral) or factor < 1:
            raise MapError(
                f"a grid cannot be refined by {shown(factor)}: expected a whole number from 1"
            )
        if factor == 1:
            return self
        if self.rows * self.columns * factor * factor > MAX_CELLS:
            raise MapError(
                f"a map of {self.size()} has too many cells of {self.resolution / factor:g} m: "
                f"expected {MAX_CELLS} at most"
            )

        def cut(array: npt.NDArray[Cell]) -> npt.NDArray[Cell]:
            return np.repeat(np.repeat(array, factor, axis=0), factor, axis=1)

        return replace(
            self,
            values=cut(self.values),
            frame=self.frame._replace(resolution=self.resolution / factor),
            keepout=None if self.keepout is None else cut(self.keepout),
            speed_limit=None if self.speed_limit is None else cut(self.speed_limit),
        )

    def _in_bounds(self, row: int, column: int) -> None:
        if not (0 <= row < self.rows and 0 <= column < self.columns):
            raise OutOfMap(
                f"cell ({row}, {column}) is off the map of {self.rows} rows, {self.columns} columns"
            )


def _array(values: Any, what: str, dtype: Any = None) -> npt.NDArray[Any]:
    """What was given as an array; raises MapError, which calls it ``what``, where it is none."""
    try:
        return np.asarray(values, dtype=dtype)
    except (OverflowError, TypeError, ValueError):
        raise MapError(f"{what} is {shown(values)}: expected numbers [rows, columns]") from None


def _framed(frame: Any) -> GridFrame:
    """The frame of a grid, from itself or the side of a cell; raises MapError for another."""
    try:
        if isinstance(frame, Real) and not isinstance(frame, bool):
            frame = GridFrame(float(frame))
        if isinstance(frame, GridFrame) and frame.resolution > 0 and all(map(math.isfinite, frame)):
            return frame
    except (OverflowError, TypeError):
        pass
    raise MapError(
        f"a grid's frame is {shown(frame)}: expected a GridFrame with a resolution > 0, all finite, or "
        "the side of a cell in metres"
    )


def _readonly(array: npt.ArrayLike, dtype: type[Cell]) -> npt.NDArray[Cell]:
    result: npt.NDArray[Cell] = np.array(array, dtype=dtype, order="C")
    result.flags.writeable = False
    return result
