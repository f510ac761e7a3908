from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynastar.episode import Episode, PlanRecord
from dynastar.footprint import box
from dynastar.metrics import measure
from dynastar.viewer import scene

NO_CELLS = np.empty((0, 2), dtype=np.int32)


def test_a_polygon_turns_with_the_robot(office: Episode):
    boxed = replace(office, footprint=box(0.8, 0.4).vertices, radius=0.5)
    corners = scene.outline(boxed, np.array([5.0, 6.0, np.pi / 2]))
    assert corners.min(axis=0) == pytest.approx((4.8, 5.6))
    assert corners.max(axis=0) == pytest.approx((5.2, 6.4))
    assert scene.nose(boxed, np.array([5.0, 6.0, np.pi / 2]))[1] == pytest.approx((5.0, 6.4))


def test_a_disc_is_round(office: Episode):
    rim = scene.outline(office, np.array([1.0, 2.0, 0.3])) - (1.0, 2.0)
    assert np.hypot(*rim.T) == pytest.approx(np.full(len(rim), office.radius))


def test_a_walk_to_and_fro_leaves_one_row_of_dots():
    times = 0.1 * np.arange(400)
    x = 4.0 * np.abs((times / 5.0) % 2.0 - 1.0)
    dots = scene.track_dots(np.column_stack([x, np.zeros(400)]), times, 0.5)
    assert 6 <= len(dots) <= 10
    assert np.diff(np.sort(dots[:, 0])).min() > 0.3


def test_a_track_is_not_bridged_over_gaps_and_jumps():
    times = 0.1 * np.arange(6)
    track = np.array([(0, 0), (0.1, 0), (9, 0), (9.1, 0), (np.nan, np.nan), (20, 0)])
    dots = scene.track_dots(track, times, 0.05)
    assert not ((dots[:, 0] > 0.2) & (dots[:, 0] < 8.9)).any()
    assert not ((dots[:, 0] > 9.2) & (dots[:, 0] < 19.9)).any()
    assert dots[:, 0].max() == pytest.approx(20.0)


def test_closest_tick():
    robot = np.array([(0, 0), (1, 0), (2, 0)], dtype=float)
    mover = np.array([(5, 0), (np.nan, np.nan), (2, 1)])
    assert scene.closest_tick(mover, robot) == 2
    assert scene.closest_tick(np.full((3, 2), np.nan), robot) is None


def test_of_a_new_plan_only_what_differs_is_drawn():
    first = np.array([(0, 0), (10, 0)], dtype=float)
    second = np.array([(2, 0), (4, 0), (5, 2), (6, 0), (10, 0)], dtype=float)
    whole, (detour,), again = scene.changes([first, second, second], 0.1)
    assert np.concatenate(whole)[:, 0].max() == pytest.approx(10.0)
    assert detour[:, 0].min() == pytest.approx(4.0, abs=0.2)
    assert detour[:, 0].max() == pytest.approx(6.0, abs=0.2)
    assert again == []


def test_plans_begun_at_one_place_share_a_label():
    begins = [(0, 0), (5, 0), (5.1, 0), (5, 0.1), (9, 9)]
    lines = [np.array([begin, (20, 0)], dtype=float) for begin in begins]
    plans = [PlanRecord(0.0, "", line, NO_CELLS) for line in lines]
    assert [words for _, _, words in scene.plan_labels(plans, 0.5)] == ["0", "1–3", "4"]


@given(st.sets(st.integers(1, 40), min_size=1))
def test_number_words_name_every_number_once(numbers: set[int]):
    named: list[int] = []
    for word in scene.number_words(sorted(numbers)).split(", "):
        first, _, last = word.partition("–")
        named += range(int(first), int(last or first) + 1)
    assert named == sorted(numbers)


def test_words(office: Episode):
    assert scene.outcome_words(measure(office)) == "arrived after 69.9 s"
    touched = replace(office, outcome="contact", contact="resting")
    assert scene.outcome_words(measure(touched)) == "contact while standing still after 69.9 s"
    assert scene.count_words(0, "replan") == "no replans"
    assert scene.count_words(1, "recovery", "recoveries") == "1 recovery"
    assert scene.count_words(2, "recovery", "recoveries") == "2 recoveries"
    assert scene.name_of(replace(office, scenario={})) == "pioneer3dx"


def test_marks_lie_away_from_what_was_driven(office: Episode):
    (start, away, letters), *_ = scene.marks(office)
    assert letters == "S"
    assert np.hypot(*away) == pytest.approx(1.0)
    assert away @ (office.trajectory.poses[40, :2] - start) < 0.0
