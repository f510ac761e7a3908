"""The suite office: the demo's scenario, its walkers moved on by the seed."""

from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from dynastar.bench.missions import Mission, Options
from dynastar.bench.suites import load_suite, office
from dynastar.errors import DataError
from dynastar.io.scenario_file import load_scenario
from dynastar.simulation.movers import Movers


def test_the_seed_says_where_people_are_and_how_senses_err() -> None:
    options = Options()
    file = load_scenario(office.office_file(options))
    one, two = (office.scenario(Mission(number), options, 0) for number in (1, 2))
    assert (one.seed, two.seed) == (1, 2)
    assert (one.noise, one.latency, one.navigator) == (file.noise, file.latency, file.navigator)
    assert (one.start, one.goals, len(one.obstacles)) == (
        file.start,
        file.goals,
        len(file.obstacles),
    )
    places = [Movers(made.movers).at(0.0) for made in (one, two)]
    assert (np.abs(places[0] - places[1]).max(axis=1) > 0.05).all()
    again = office.scenario(Mission(1), options, 3)
    assert np.array_equal(Movers(again.movers).at(7.0), Movers(one.movers).at(7.0))


def test_people_keep_to_their_walks() -> None:
    options = Options()
    file = load_scenario(office.office_file(options))
    made = office.scenario(Mission(4), options, 0)
    for before, after in zip(file.movers, made.movers, strict=True):
        assert np.array_equal(before.points, after.points)
        assert np.diff(before.times) == pytest.approx(np.diff(after.times))
        assert after.times[0] <= 0.0


def test_ideal_has_neither_errors_nor_latency() -> None:
    made = office.scenario(Mission(0), Options(ideal=True), 0)
    assert not any(made.noise)
    assert made.latency == 0.0


def test_the_office_is_found_in_the_data_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "office").mkdir()
    mine = tmp_path / "office" / "office.toml"
    mine.touch()
    assert office.office_file(Options(data=tmp_path)) == mine
    assert office.office_file(Options(data=tmp_path / "office")) == mine
    monkeypatch.setattr(office, "EXAMPLES", tmp_path / "nowhere")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(DataError, match=r"office\.toml"):
        office.office_file(Options())


def test_ten_missions_and_more() -> None:
    suite = load_suite("office")
    assert suite.DEFAULT_MISSIONS == 10
    assert [mission.number for mission in islice(suite.missions(Options()), 12)] == list(range(12))
