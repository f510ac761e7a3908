"""Every example runs, and the office is what its files say."""

import importlib.util
import re
import runpy
from contextlib import nullcontext
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from dynastar import load_map, load_scenario, run
from dynastar.errors import DynastarWarning
from dynastar.metrics import measure
from dynastar.planning import segment_clear
from dynastar.simulation import Scenario

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "examples"
PROGRAMS = sorted(EXAMPLES.glob("[0-9]*.py"))
LANE_CLEARANCE = 0.4  # m, from the middle of a walker's lane to anything


def arrives(scenario: Scenario, replans: int = 1) -> None:
    result = measure(run(scenario))
    assert (result.outcome, result.contacts_moving, result.contacts_resting) == (
        *("arrived", 0, 0),
    ), result.reason
    assert result.replans >= replans


def check_lanes(scenario: Scenario) -> None:
    """Walkers keep clear of the walls and of the unmapped obstacles, by the map and by shapely."""
    import shapely

    solids = shapely.union_all([shapely.Polygon(corners) for corners in scenario.obstacles])
    for mover in scenario.movers:
        assert shapely.LineString(mover.points).distance(solids) >= LANE_CLEARANCE
        cells = scenario.grid.frame.points_to_grid(mover.points)
        reach = LANE_CLEARANCE / scenario.grid.resolution
        for a, b in pairwise(cells):
            assert segment_clear(scenario.grid.blocked(), a, b, reach), mover.points


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda path: path.stem)
def test_programs_run_and_are_short(
    program: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert len(program.read_text().splitlines()) <= 40
    monkeypatch.chdir(ROOT)
    runpy.run_path(str(program), run_name="__main__")
    said = capsys.readouterr().out
    assert "improved" in said or "arrived" in said
    if program.stem == "10_guard":
        _, *ends = (tuple(line.split()[-2:]) for line in said.splitlines())
        assert len(ends) == 6
        assert sum(alone == "contact" for alone, _ in ends) >= 3
        assert {guarded for _, guarded in ends} <= {"arrived", "stopped"}


def test_the_readme_shows_the_drive_example() -> None:
    shown = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    assert shown[0].strip() in (EXAMPLES / "02_drive.py").read_text()


def test_the_office_is_what_its_script_draws() -> None:
    spec = importlib.util.spec_from_file_location("draw", EXAMPLES / "office" / "draw_office.py")
    assert spec is not None
    assert spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    drawn, stored = script.draw(), load_map(EXAMPLES / "office" / "office.yaml")
    assert np.array_equal(drawn.values, stored.values)
    assert drawn.frame == stored.frame
    assert sum(path.stat().st_size for path in (EXAMPLES / "office").iterdir()) < 1_000_000


def test_the_office_is_full_of_surprises() -> None:
    scenario = load_scenario(EXAMPLES / "office" / "office.toml")
    assert len(scenario.obstacles) >= 6
    assert len(scenario.movers) >= 4
    check_lanes(scenario)


@pytest.mark.slow
def test_the_robot_crosses_the_office() -> None:
    arrives(load_scenario(EXAMPLES / "office" / "office.toml"))


@pytest.mark.data
@pytest.mark.slow
@pytest.mark.parametrize("name", ["depot", "willow"])
def test_the_robot_crosses_real_maps(
    name: str, data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DYNASTAR_DATA", str(data_dir))
    told = pytest.warns(DynastarWarning, match="free_thresh 0.25 makes .* 4.8 %")
    with told if name == "depot" else nullcontext():
        scenario = load_scenario(EXAMPLES / f"{name}.toml")
    assert scenario.obstacles
    assert scenario.movers
    check_lanes(scenario)
    arrives(scenario)


FEATURES = sorted((EXAMPLES / "features").glob("*.toml"))


@pytest.mark.slow
@pytest.mark.parametrize("file", FEATURES, ids=lambda path: path.stem)
def test_each_feature_of_scenarios_has_an_example_that_arrives(file: Path) -> None:
    scenario = load_scenario(file)
    episode = run(scenario)
    result = measure(episode)
    contacts = result.contacts_moving, result.contacts_resting
    assert (result.outcome, *contacts) == ("arrived", 0, 0), result.reason
    assert result.goals_reached == len(scenario.goals)
    poses, speeds = episode.trajectory.poses, episode.trajectory.twists[:, 0]
    cells = tuple(np.array([scenario.grid.world_to_cell(x, y) for x, y, _ in poses]).T)
    if scenario.grid.keepout is not None:
        assert scenario.grid.keepout.any()
        assert not scenario.grid.keepout[cells].any()
    if scenario.grid.speed_limit is not None:
        limits = scenario.grid.speed_limit[cells]
        assert np.isfinite(limits).any()
        assert (speeds <= limits + 0.02).all()
    if scenario.unknown == "free" and scenario.grid.keepout is None:
        assert scenario.grid.unknown[cells].any()


def test_the_hall_is_what_its_script_draws() -> None:
    drawn = runpy.run_path(str(EXAMPLES / "features" / "draw_hall.py"))["draw"]()
    for name, grid in drawn.items():
        stored = load_map(EXAMPLES / "features" / f"{name}.yaml")
        assert np.array_equal(grid.values, stored.values)
        assert grid.frame == stored.frame


PLAY = sorted((EXAMPLES / "play").glob("*.toml"))


def test_the_field_is_what_its_script_draws(monkeypatch: pytest.MonkeyPatch) -> None:
    written: list[str] = []
    monkeypatch.setattr(Path, "write_text", lambda self, text: written.append(text))
    runpy.run_path(str(EXAMPLES / "play" / "draw_field.py"))["main"]()
    monkeypatch.undo()
    assert written == [(EXAMPLES / "play" / "field.toml").read_text()]


@pytest.mark.parametrize("file", PLAY, ids=lambda path: path.stem)
def test_the_playgrounds_scenes_can_be_driven(file: Path) -> None:
    scenario = load_scenario(file)
    if scenario.obstacles and scenario.movers:
        check_lanes(scenario)
    if not scenario.movers:
        arrives(scenario, replans=0)
        return
    x, y, heading = scenario.start
    starts = [(x + right, y, heading) for right in (-0.1, 0.0, 0.1)]
    results = [measure(run(replace(scenario, start=start))) for start in starts]
    assert sum(result.contacts_moving for result in results) == 0
    assert sum(result.outcome == "arrived" for result in results) >= 2  # walkers react to nobody
