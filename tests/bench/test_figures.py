from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

from dynastar.bench import figures, paper
from dynastar.metrics import measure
from dynastar.viewer.sheet import save


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    place = tmp_path_factory.mktemp("figures") / "new"
    written = figures.draw_all(place)
    assert sorted(written) == sorted(place.iterdir())
    return place


@pytest.mark.parametrize("name", figures.FIGURES)
def test_a_figure_is_there_in_both_formats(folder: Path, name: str):
    assert ElementTree.parse(folder / f"{name}.svg").getroot().tag.endswith("svg")
    with Image.open(folder / f"{name}.png") as image:
        assert image.width in (990, 2070)  # a column, or the page, at 300 dpi
        assert np.asarray(image.convert("L")).std() > 10.0
    for suffix in figures.SUFFIXES:
        assert 5_000 < (folder / f"{name}{suffix}").stat().st_size < 1_000_000


@pytest.mark.parametrize("name", figures.FIGURES)
def test_drawn_again_it_is_the_same(folder: Path, tmp_path: Path, name: str):
    again = save(figures.FIGURES[name](), tmp_path / "again.svg")
    assert again.read_bytes() == (folder / f"{name}.svg").read_bytes()


def test_the_searches_say_what_they_found():
    words = [text.get_text() for text in figures.searches().texts]
    assert "704 cells expanded, length 66.3" in words
    improved = next(w for w in words if w.startswith("73 cells expanded, length 72.0, smoothed"))
    assert float(improved.split()[-1]) < 66.3


def test_the_driven_line_is_the_missions():
    episode = figures.own_mission()
    driven = measure(episode)
    words = " ".join(text.get_text() for text in figures.driven().texts)
    assert driven.outcome == "arrived"
    assert f"{driven.length:.1f} m, {driven.turning_points} turning point" in words


def test_a_line_touches_where_it_first_enters():
    square = np.array([(2.0, 0.0), (3.0, 0.0), (3.0, 1.0), (2.0, 1.0)])
    way = np.array([(0.0, 0.5), (4.0, 0.5), (4.0, 3.0), (2.5, 3.0), (2.5, 0.0)])
    assert figures.touches(way, (square, square + 10.0)) == pytest.approx(
        np.array([(2.0, 0.5)]), abs=1e-5
    )
    beside = np.array([(0.0, 1.0), (4.0, 1.0)])
    assert figures.touches(beside, (square,)).shape == (0, 2)


def test_fig_6_counts_the_unknown_obstacles_that_the_path_meets():
    world = paper.own_world()
    figure = figures.unaware()
    crosses = [line for line in figure.axes[0].lines if line.get_marker() == "x"]
    met = len(crosses[0].get_xdata())
    words = " ".join(text.get_text() for text in figure.texts)
    assert f"meets {met} of {len(world.obstacles)} unknown obstacles" in words
