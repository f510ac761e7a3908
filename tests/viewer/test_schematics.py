import math
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

from dynastar.errors import InputError
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.robot import ROBOTS
from dynastar.viewer import schematics
from dynastar.viewer.cells import outline_of
from dynastar.viewer.schematics import braking, system
from dynastar.viewer.sheet import COLUMN, PAGE, save, sheet

GRID = OccupancyGrid.from_text("....\n.##.\n....", 0.5, 3.0, -2.0)

DRAWN = {
    "numbering": lambda: schematics.draw_numbering(GRID, 8),
    "drive": schematics.draw_drive,
    "braking": lambda: schematics.draw_braking(ROBOTS["paper"]),
    "system": schematics.draw_system,
}


def words_in(figure: Figure) -> list[Text]:
    return [t for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip()]


def test_every_cell_has_its_number_of_eq_1_at_its_place():
    (axes,) = schematics.draw_numbering(GRID, 8).axes
    places = {t.get_text(): t.get_position() for t in axes.texts}
    assert len(places) == 12
    for number in range(1, 13):
        row, column = divmod(number - 1, 4)  # from the top left
        assert places[str(number)][0] == pytest.approx(0.5 * (column + 0.5))
        if number != 8:
            assert places[str(number)][1] == pytest.approx(0.5 * (3 - row - 0.5))


def test_the_shown_centre_is_that_of_the_corrected_eq_1():
    figure = schematics.draw_numbering(GRID, 8)  # mod(8, 4) = 0, where the printed one breaks
    words = " ".join(t.get_text() for t in figure.texts)
    assert "x_{8} = 3.5" in words
    assert "y_{8} = 1.5" in words
    (dot,) = (line for line in figure.axes[0].lines if line.get_marker() == "o")
    assert (dot.get_xdata()[0], dot.get_ydata()[0]) == (1.75, 0.75)


def test_dist_is_along_the_arc_to_the_first_contact():
    dist = braking.distance_to_contact(braking.OBSTACLE, 0.3)
    corners = braking.OBSTACLE
    dense = np.vstack(
        [a + (b - a) * np.linspace(0, 1, 400)[:, None]
         for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    )  # fmt: skip
    gaps = [np.hypot(*(dense - braking.on_arc(s)[:2]).T).min() for s in np.arange(0.0, dist, 0.02)]
    assert min(gaps) > 0.3 - 1e-6
    assert np.hypot(*(dense - braking.on_arc(dist)[:2]).T).min() == pytest.approx(0.3, abs=3e-3)
    assert braking.distance_to_contact(braking.OBSTACLE + 100.0, 0.3) == math.inf


def test_one_speed_is_admissible_and_one_is_not():
    words = " ".join(t.get_text() for t in words_in(DRAWN["braking"]()))
    slow, fast = braking.SPEEDS
    dist = braking.distance_to_contact(braking.OBSTACLE, ROBOTS["paper"].footprint.circumscribed)
    assert slow**2 / 0.4 < dist < fast**2 / 0.4
    assert f"= {slow**2 / 0.4:.2f} m,  admissible" in words
    assert f"= {fast**2 / 0.4:.2f} m,  not admissible" in words


def test_the_plan_names_modules_that_there_are():
    source = Path(system.__file__).parents[2]
    named = [block.module for block in system.BLOCKS.values()] + [s[2] for s in system.STAGES]
    modules = [name for names in named for name in names.replace("\n", ", ").split(", ") if name]
    assert len(modules) > 15
    for module in modules:
        place = source.joinpath(*module.split("."))
        assert place.is_dir() or place.with_suffix(".py").is_file(), module


@pytest.mark.parametrize("name", DRAWN)
def test_words_stay_on_the_sheet_and_off_each_other(name: str):
    figure = DRAWN[name]()
    assert figure.get_figwidth() == (PAGE if name == "system" else COLUMN)
    figure.canvas.draw()
    boxes = [(t.get_text(), Text.get_window_extent(t)) for t in words_in(figure)]
    width, height = figure.bbox.width, figure.bbox.height
    for number, (words, box) in enumerate(boxes):
        assert box.x0 > 0.0, words
        assert box.y0 > 0.0, words
        assert box.x1 < width, words
        assert box.y1 < height + 0.5, words
        for other, second in boxes[number + 1 :]:
            rotated = name == "braking"
            if not rotated:
                across = min(box.x1, second.x1) - max(box.x0, second.x0)
                down = min(box.y1, second.y1) - max(box.y0, second.y0)
                assert min(across, down) < 1.5, (words, other)


@pytest.mark.parametrize("name", DRAWN)
def test_the_same_drawing_is_the_same_vectors(name: str, tmp_path: Path):
    first = save(DRAWN[name](), tmp_path / "first.svg").read_bytes()
    second = save(DRAWN[name](), tmp_path / "second.svg").read_bytes()
    assert first == second
    assert ElementTree.fromstring(first).tag.endswith("svg")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["first.svg", "second.svg"]


def test_a_sheet_is_saved_as_png_svg_or_pdf_alone(tmp_path: Path):
    with pytest.raises(InputError, match=r"\.png, \.svg, \.pdf"):
        save(sheet(1.0, 1.0), tmp_path / "sheet.jpg")


def test_cells_are_one_outline_with_its_holes():
    ring = [(r, c) for r in range(3) for c in range(3) if (r, c) != (1, 1)]
    outline = outline_of(ring, GridFrame(2.0, 10.0, 20.0))
    assert outline.get_extents().bounds == pytest.approx((10.0, 20.0, 6.0, 6.0))
    assert (outline.codes == 1).sum() == 2  # the outer ring and the hole
    areas = [
        0.5 * np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])
        for x, y in (ring.T for ring in outline.to_polygons(closed_only=True))
    ]
    assert sorted(areas) == pytest.approx([-4.0, 36.0]) or sorted(areas) == [-36.0, 4.0]
    assert len(outline_of(np.empty((0, 2)), GridFrame(1.0)).vertices) == 0
