"""A survey scores every admissible sample and chooses as the search that drops them early does."""

import math

import numpy as np
import pytest

from dynastar.dwa import DynamicWindow
from dynastar.dwa.config import DwaConfig
from dynastar.dwa.scene import FOLLOW, Manoeuvre
from dynastar.geometry import Pose2D, Twist
from dynastar.perception import MovingObstacle
from dynastar.robot import Footprint, Limits, Robot
from scenes import boxed, scene_of

ROUND = Robot("round", Limits(1.0, 1.5, 0.8, 2.0, 0.8, 2.0, v_min=-0.3), Footprint.disc(0.3))


def test_a_survey_chooses_the_same_and_scores_all_that_do_not_touch():
    rng, more = np.random.default_rng(4), 0
    window = DynamicWindow(ROUND, DwaConfig(), 0.1)
    closed = boxed((3.5, 2.5, 3.7, 5.5))
    for _ in range(60):
        pose = Pose2D(rng.uniform(1.0, 3.0), rng.uniform(1.0, 7.0), rng.uniform(-3.0, 3.0))
        twist = Twist(rng.uniform(0.0, 0.8), rng.uniform(-0.5, 0.5))
        x, y = rng.uniform(4.5, 7.0), rng.uniform(1.0, 7.0)
        movers = (MovingObstacle(x, y, -0.6, rng.uniform(-0.3, 0.3), 0.3),)
        last = Manoeuvre(*twist, 0.5, FOLLOW)
        scene = scene_of(closed, radius=0.3, movers=movers, last=last)
        choice, survey = window.choose(pose, twist, scene), window.survey(pose, twist, scene)
        assert survey.command == choice.command
        assert survey.manoeuvre == choice.manoeuvre
        scored = np.isfinite(choice.score)
        assert (np.isfinite(survey.score) | ~scored).all()
        more += int(np.isfinite(survey.score).sum() - scored.sum())
        if choice.manoeuvre is not None:
            assert survey.score.max() == pytest.approx(choice.score.max())
        assert window.choose(pose, twist, scene).command == choice.command
        assert not math.isnan(survey.score.max())
    assert more > 0


def test_a_complete_window_scores_all_in_its_choice():
    window = DynamicWindow(ROUND, DwaConfig(), 0.1)
    scene, pose = scene_of(boxed((3.5, 2.5, 3.7, 5.5)), radius=0.3), Pose2D(2.0, 4.0, 0.3)
    survey = window.survey(pose, Twist(0.3, 0.1), scene)
    assert not window.complete
    window.complete = True
    choice = window.choose(pose, Twist(0.3, 0.1), scene)
    assert np.array_equal(choice.score, survey.score)
    assert choice.command == survey.command
