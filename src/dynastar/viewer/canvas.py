"""A picture in Pillow with metres for coordinates, drawn twice as large and reduced at the end."""

from copy import copy
from functools import cache
from pathlib import Path as FilePath

import cv2
import matplotlib
import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw, ImageFont
from PIL.ImageColor import getrgb

from dynastar.grid import OccupancyGrid
from dynastar.path import Path
from dynastar.viewer import palette
from dynastar.viewer.view import LARGEST_IMAGE, View, map_image

Floats = npt.NDArray[np.float64]
Pixels = list[tuple[float, float]]

FINE = 2  # drawn pixels a side of a final one


class Canvas:
    """The world in ``view`` on a picture at most ``width`` x ``height`` final pixels.

    Above and below the world are strips of ``strip`` final pixels for words. Lengths on the paper
    (line widths, dashes, letters) are in final pixels, those in the world in metres.
    """

    def __init__(self, view: View, width: int, height: int, strip: int) -> None:
        self.view = view
        self.scale = FINE * min(width / view.width, height / view.height)  # drawn pixels a metre
        self.strip = strip
        columns = max(1, round(view.width * self.scale / FINE))
        rows = max(1, round(view.height * self.scale / FINE))
        self.size = (columns, rows + 2 * strip)
        self.image = Image.new("RGB", (FINE * columns, FINE * self.size[1]), palette.FREE)
        self.pen = ImageDraw.Draw(self.image)

    def duplicate(self) -> "Canvas":
        """The same picture again, to draw more on."""
        other = copy(self)
        other.image = self.image.copy()
        other.pen = ImageDraw.Draw(other.image)
        return other

    def reduced(self) -> Image.Image:
        """The picture at its final size."""
        return self.image.reduce(FINE)

    def pixels(self, points: Floats) -> Pixels:
        """Drawn pixels (column, row), rows downward, of world points (n, 2)."""
        columns = (points[:, 0] - self.view.x_low) * self.scale
        rows = (self.view.y_high - points[:, 1]) * self.scale + FINE * self.strip
        return list(zip(columns.tolist(), rows.tolist(), strict=True))

    def show_map(self, grid: OccupancyGrid) -> None:
        """The map, placed by its own origin and yaw."""
        finest = round(grid.resolution * max(grid.rows, grid.columns) * self.scale)
        window = map_image(grid, self.view, max(1, min(finest, LARGEST_IMAGE)))
        if window.rgb.size == 0:
            return
        height, width = window.rgb.shape[:2]
        rows, columns = window.row_end - window.row, window.column_end - window.column
        cells = np.array([(0, 0), (0, columns), (rows, 0)])
        cells += np.array([window.row, window.column])
        corners = grid.frame.points_to_world(cells)
        to_pixels = cv2.getAffineTransform(
            np.array([(0, 0), (width, 0), (0, height)], dtype=np.float32) - np.float32(0.5),
            np.array(self.pixels(corners), dtype=np.float32) - np.float32(0.5),
        )
        drawn = cv2.warpAffine(
            window.rgb,
            to_pixels,
            self.image.size,
            flags=cv2.INTER_NEAREST,
            borderMode=cv2.BORDER_CONSTANT,
            borderValue=getrgb(palette.UNKNOWN),
        )
        self.image.paste(Image.fromarray(np.asarray(drawn, dtype=np.uint8)))

    def polygon(self, points: Floats, face: str, edge: str, width: float = 1.0) -> None:
        """A filled polygon (k, 2)."""
        corners = self.pixels(points)
        self.pen.polygon(corners, fill=face)
        self.pen.line([*corners, corners[0]], fill=edge, width=round(FINE * width), joint="curve")

    def disc(self, centre: Floats, radius: float, face: str | None, edge: str) -> None:
        """A disc of ``radius`` metres; without ``face`` only its edge."""
        reach = radius * self.scale
        ((column, row),) = self.pixels(np.asarray(centre, dtype=float).reshape(1, 2))
        box = (column - reach, row - reach, column + reach, row + reach)
        self.pen.ellipse(box, fill=face, outline=edge, width=FINE)

    def line(self, points: Floats, colour: str, width: float) -> None:
        """A line through points (n, 2)."""
        if len(points) > 1:
            self.pen.line(
                self.pixels(points), fill=colour, width=round(FINE * width), joint="curve"
            )

    def dashes(self, points: Floats, on: float = 6.0, off: float = 4.0) -> list[Pixels]:
        """The dashes of a line through points (n, 2), for ``draw_dashes``."""
        path = Path(points)
        metre = FINE / self.scale
        begins = np.arange(0.0, max(path.length, 1e-9), (on + off) * metre)
        ends = begins + on * metre
        return [
            self.pixels(path.resampled(begin, end, 0.5 * on * metre))
            for begin, end in zip(begins, ends, strict=True)
        ]

    def draw_dashes(self, dashes: list[Pixels], colour: str, width: float) -> None:
        """Draws what ``dashes`` gave."""
        for dash in dashes:
            self.pen.line(dash, fill=colour, width=round(FINE * width))

    def cross(self, centre: Floats, reach: float, colour: str, width: float) -> None:
        """A lying cross with arms of ``reach`` final pixels."""
        ((column, row),) = self.pixels(np.asarray(centre, dtype=float).reshape(1, 2))
        arm = FINE * reach
        for sign in (1, -1):
            ends = (column - arm, row - sign * arm, column + arm, row + sign * arm)
            self.pen.line(ends, fill=colour, width=round(FINE * width))

    def badge(self, centre: Floats, away: Floats, letters: str) -> None:
        """Letters in a dark disc, 18 pixels the way ``away`` (2,) from a place, on the picture."""
        ((column, row),) = self.pixels(np.asarray(centre, dtype=float).reshape(1, 2))
        reach = (7 if len(letters) == 1 else 9) * FINE
        width, height = self.image.size
        across = min(max(column + 18 * FINE * float(away[0]), reach), width - 1 - reach)
        down = min(max(row - 18 * FINE * float(away[1]), reach), height - 1 - reach)
        at = (across, down)
        self.pen.line((column, row, *at), fill=palette.INK, width=FINE)
        box = (at[0] - reach, at[1] - reach, at[0] + reach, at[1] + reach)
        self.pen.ellipse(box, fill=palette.INK)
        self.pen.text(at, letters, fill="white", font=letters_font(10, bold=True), anchor="mm")

    def band(self, bottom: bool = False) -> None:
        """Clears the upper or the lower strip."""
        width, height = self.image.size
        low = height - FINE * self.strip if bottom else 0
        self.pen.rectangle((0, low, width, low + FINE * self.strip - 1), fill=palette.FREE)

    def words(self, text: str, colour: str, bold: bool = False, right: bool = False) -> None:
        """A line of words in the upper strip, from the left or against the right."""
        column = self.image.size[0] - 8 * FINE if right else 8 * FINE
        place, anchor = (column, 0.5 * FINE * self.strip), "rm" if right else "lm"
        self.pen.text(place, text, fill=colour, font=letters_font(12, bold), anchor=anchor)


@cache
def letters_font(size: int, bold: bool = False) -> ImageFont.FreeTypeFont:
    """The figures' own typeface, ``size`` final pixels high."""
    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    file = FilePath(matplotlib.get_data_path()) / "fonts" / "ttf" / name
    return ImageFont.truetype(str(file), FINE * size)
