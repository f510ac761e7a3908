from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.patches import Rectangle

from dynastar.viewer.sheet import save
from dynastar.viewer.spread import Column, Spread, draw_columns, draw_parts, draw_spreads

RNG = np.random.default_rng(5)
VALUES = {
    name: (scale * np.exp(0.4 * RNG.normal(size=count))).tolist()
    for name, scale, count in (("mazes", 0.3, 200), ("rooms", 0.8, 31), ("one", 0.5, 1))
}


def medians(axes):
    return [line.get_xdata()[0] for line in axes.lines if line.get_gid() == "median"]


@pytest.mark.parametrize("log", [False, True])
def test_medians_and_quartiles_are_those_of_the_data(log: bool):
    (axes,) = draw_spreads([Spread("ratio", VALUES, log=log)]).axes
    assert medians(axes) == pytest.approx([np.median(v) for v in VALUES.values()])
    boxes = [p for p in axes.patches if isinstance(p, Rectangle) and p.get_height() == 0.56]
    for box, values in zip(boxes, VALUES.values(), strict=True):
        begin, end = np.quantile(values, (0.25, 0.75))
        assert (box.get_x(), box.get_width()) == pytest.approx((begin, end - begin))
    assert axes.get_xscale() == ("log" if log else "linear")
    assert axes.get_ylim()[0] > axes.get_ylim()[1]  # the first group is on top


def test_whiskers_worst_and_what_is_printed():
    spread = Spread("ratio", VALUES, printed={"rooms": 0.5}, reference=1.0)
    (axes,) = draw_spreads([spread]).axes
    whiskers = [line.get_xdata() for line in axes.lines if len(set(line.get_ydata())) == 1]
    low, high = np.quantile(VALUES["mazes"], (0.05, 0.95))
    assert any(np.allclose(x, (low, high)) for x in whiskers if len(x) == 2)
    worst = [line.get_xdata()[0] for line in axes.lines if line.get_marker() == "x"]
    assert worst == [max(v) for v in VALUES.values()]
    (printed,) = (line for line in axes.lines if line.get_marker() == "D")
    assert (printed.get_xdata()[0], printed.get_ydata()[0]) == (0.5, 1)
    low_is_worst = spread._replace(high_is_worst=False)
    (axes,) = draw_spreads([low_is_worst]).axes
    worst = [line.get_xdata()[0] for line in axes.lines if line.get_marker() == "x"]
    assert worst == [min(v) for v in VALUES.values()]


def test_groups_without_values_and_values_that_are_not_finite():
    values = {"none": [], "some": [1.0, np.nan, 3.0, np.inf]}
    (axes,) = draw_spreads([Spread("ratio", values)]).axes
    assert medians(axes) == [2.0]


def test_columns_have_each_arms_number():
    time = Column("time, s", {"default": 75.0, "paper": 93.0, "none": None})
    length = Column("length, m", {"default": 28.9, "paper": 29.4, "none": np.nan}, ".2f")
    figure = draw_columns([time, length], best="default")
    for axes, column in zip(figure.axes, (time, length), strict=True):
        dots = [line for line in axes.lines if line.get_marker() == "o"]
        shown = [column.values["default"], column.values["paper"]]
        assert [dot.get_xdata()[0] for dot in dots] == shown
        words = [text.get_text() for text in axes.texts]
        assert words == [*(format(v, column.format) for v in shown), "–"]
    names = [label.get_text() for label in figure.axes[0].get_yticklabels()]
    assert names == ["default", "paper", "none"]


def test_parts_follow_one_another_in_a_bar():
    parts = {"arrived": {"a": 60.0, "b": 0.0}, "hit": {"a": 30.0, "b": 90.0}}
    (axes,) = draw_parts("worlds, %", parts).axes
    bars = [[(bar.get_x(), bar.get_width()) for bar in bars] for bars in axes.containers]
    assert bars == [[(0.0, 60.0), (0.0, 0.0)], [(60.0, 30.0), (0.0, 90.0)]]
    assert [text.get_text() for text in axes.texts] == ["60", "0"]
    assert axes.get_xlim() == (0.0, 90.0)


def test_intervals_are_lines_through_the_dots():
    values = {"default": 75.0, "paper": 93.0}
    column = Column("arrived, %", values, intervals={"default": (70.0, 80.0), "paper": None})
    (axes,) = draw_columns([column]).axes
    lines = [line for line in axes.lines if len(line.get_xdata()) == 2]
    assert [(*line.get_xdata(), *line.get_ydata()) for line in lines] == [(70.0, 80.0, 0, 0)]


def test_the_words_of_narrow_columns_do_not_overlap():
    column = Column("people\ntime / default's", {"a name of an arm, a long one": 0.9, "b": 1.7})
    share = Column("people\narrived, %", {"a name of an arm, a long one": 6.0, "b": 80.0})
    figure = draw_columns([column, share._replace(range=(0.0, 100.0)), share] * 2)
    figure.canvas.draw()
    boxes = [axes.xaxis.label.get_window_extent() for axes in figure.axes]
    for axes in figure.axes:
        low, high = axes.get_xlim()
        shown = [text for text in axes.get_xticklabels() if low <= text.get_position()[0] <= high]
        assert shown
        boxes += [text.get_window_extent() for text in shown]
    for k, box in enumerate(boxes):
        assert box.y0 > 0.0
        assert not any(box.overlaps(other) for other in boxes[:k])
    assert figure.axes[1].get_xlim() == (0.0, 100.0)


@pytest.mark.parametrize("count", [1, 3])
def test_words_stay_on_the_sheet_and_the_file_is_the_same(tmp_path: Path, count: int):
    spreads = [Spread("ratio", VALUES, printed=0.5, log=True)] * count
    figure = draw_spreads(spreads)
    figure.canvas.draw()
    for axes in figure.axes:
        for text in [*axes.texts, axes.xaxis.label, *axes.get_yticklabels()]:
            box = text.get_window_extent()
            assert box.x0 > 0.0
            assert box.x1 < figure.bbox.width
    begin = save(figure, tmp_path / "a.svg").read_bytes()
    assert begin == save(draw_spreads(spreads), tmp_path / "b.svg").read_bytes()
    assert ElementTree.fromstring(begin).tag.endswith("svg")
