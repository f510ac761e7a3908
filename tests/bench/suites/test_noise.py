"""The noise of missions: each has its own, and an ideal one has none."""

from itertools import islice

import pytest

from dynastar.bench.missions import Options
from dynastar.bench.suites import bounds, crowdnav, faults, people, physics, random_worlds, robots
from dynastar.simulation import Noise
from dynastar.simulation.imperfections import Drivetrain, Odometry

GENERATED = bounds, crowdnav, faults, people, physics, random_worlds, robots


def some(suite, options):
    kept = (m for m in suite.missions(options) if not suite.leave_out(m, options))
    return [suite.scenario(mission, options, 0) for mission in islice(kept, 3)]


@pytest.mark.parametrize("suite", GENERATED, ids=lambda suite: suite.__name__)
def test_every_mission_has_noise_of_its_own(suite):
    assert len({made.seed for made in some(suite, Options(seed=5))}) == 3


@pytest.mark.parametrize(
    "suite", [bounds, physics, random_worlds, robots], ids=lambda s: s.__name__
)
def test_ideal_is_without_noise_and_latency(suite):
    for made in some(suite, Options(seed=5, ideal=True)):
        assert (made.noise, made.latency) == (Noise(), 0.0)
        assert (made.drive, made.odometry) == (Drivetrain(), Odometry())
