"""The suite bounds: the worlds of random, errors as large as declared and no larger."""

from itertools import islice

import pytest

from dynastar.bench.missions import Options
from dynastar.bench.suites import bounds, random_worlds
from dynastar.simulation.run import effective_config

NUMBERS = (0, 2, 20, 40)


def mission(number):
    return next(islice(bounds.missions(Options()), number, None))


@pytest.mark.parametrize("number", NUMBERS)
def test_the_worlds_are_those_of_random_and_errors_are_as_declared(number):
    made = bounds.scenario(mission(number), Options(), 0)
    easier = random_worlds.scenario(mission(number), Options(), 0)
    assert made.grid is easier.grid
    assert made.start == easier.start
    config = effective_config(made)
    assert config.range_error == made.noise.range_bound == 0.02
    assert config.pose_error >= made.noise.pose_bound
    assert config.heading_error == made.noise.heading_bound > 0.0
    assert config.latency == made.latency >= made.drive.latency_jitter > 0.0
    for gain in (made.drive.gain_v, made.drive.gain_omega):
        assert abs(gain - 1.0) == pytest.approx(config.drive_error)
    assert 20.0 < made.time_limit < easier.time_limit


def test_all_combinations_of_gains_come():
    missions = [mission(18 * k) for k in range(16)]
    found = {
        (*made.drive[:2], *made.odometry)
        for m in missions
        if not bounds.leave_out(m, Options())
        for made in [bounds.scenario(m, Options(), 0)]
    }
    assert len(found) >= 14


def test_a_row_has_its_kind_and_its_contacts():
    options = Options(controller="dynastar.bench.controllers.guarded:Straight")
    row = bounds.run_mission(mission(2), options, 0)
    assert (row["outcome"], row["contacts_moving"], row["group"]) == ("contact", 1, "clutter")
    kept = options._replace(controller="dynastar.bench.controllers.guarded:GuardedAdversary")
    row = bounds.run_mission(mission(2), kept, 0)
    assert (row["outcome"], row["contacts_moving"]) == ("blocked", 0)
