import pytest

from dynastar.viewer.intervals import Measure, draw_intervals
from dynastar.viewer.spread import Column, Spread, draw_columns, draw_spreads

GROUPS = ["first", "second"]


def test_each_measure_has_a_column_and_each_group_a_row():
    figure = draw_intervals(
        [
            Measure("one", {"": {"first": (50.0, 40.0, 60.0)}}, (0.0, 100.0)),
            Measure("two", {"a": {"first": (1.0, None, None)}, "b": {"second": (2.0, 1.0, 3.0)}}),
        ],
        GROUPS,
    )
    one, two = figure.axes
    assert [label.get_text() for label in one.get_yticklabels()] == GROUPS
    assert (one.get_xlabel(), two.get_xlabel()) == ("one", "two")
    assert one.get_xlim() == (0.0, 100.0)
    interval, dot = one.lines
    assert list(interval.get_xdata()) == [40.0, 60.0]
    assert list(dot.get_xdata()) == [50.0]
    assert list(dot.get_ydata()) == [0.0]
    assert [list(line.get_xdata()) for line in two.lines] == [[1.0], [1.0, 3.0], [2.0]]
    alone, second = two.lines[0].get_ydata()[0], two.lines[2].get_ydata()[0]
    assert alone == pytest.approx(-0.11)
    assert second == pytest.approx(1.11)
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["a", "b"]


def test_no_group_at_all_is_a_picture_too():
    assert draw_intervals([Measure("one", {"": {}})], []).axes


def test_names_with_dollars_are_no_formulas():
    name = r"$\frac{1}{$"
    figures = (
        draw_intervals([Measure("one", {name: {name: (1.0, 0.0, 2.0)}, "b": {}})], [name]),
        draw_spreads([Spread("one", {name: [1.0, 2.0]})]),
        draw_columns([Column("one", {name: 1.0})]),
    )
    for figure in figures:
        figure.canvas.draw()
