"""A session without a server: what messages do to the scene, and what pages are told."""

import json
from dataclasses import replace

import numpy as np
import pytest
import shapely

from dynastar import io
from dynastar.errors import InputError
from dynastar.io.examples import example_scenarios
from dynastar.play import scenery, session
from dynastar.play.messages import read_message
from dynastar.play.session import Session
from dynastar.play.settings import sliders
from dynastar.simulation import ControlLoop, Drivetrain, World

SCENES = example_scenarios()


def ask(live, **message):
    live.take(read_message(json.dumps(message)))


def drive(scene, seconds, until=lambda: False):
    for _ in range(round(seconds / session.PERIOD)):
        scene.tick()
        if until():
            return
    assert not until.__code__.co_names or until()


def told(scene):
    return [json.loads(text) for text in scene.journal.entries]


def shown_obstacles(messages):
    """The obstacles that a page knows after messages."""
    rings = dict(enumerate(messages[0]["obstacles"]))
    for message in messages:
        if message["type"] == "obstacles":
            rings = {k: ring for k, ring in rings.items() if k not in message["gone"]}
            rings |= dict(message["new"])
    return list(rings.values())


@pytest.fixture
def trap():
    return Session(io.load_scenario(SCENES["u_trap"]), SCENES)


@pytest.fixture
def field():
    """An empty hall of 14 m x 10 m."""
    scenario = io.load_scenario(SCENES["u_trap"])
    return Session(replace(scenario, obstacles=(), start=(2.0, 2.0, 0.0)), SCENES)


def test_it_arrives_at_a_goal_and_at_several_in_order(field):
    ask(field, type="goals", goals=[[4.0, 2.0, None], [4.0, 4.0, 1.57]])
    passed = []
    drive(field, 30.0, lambda: passed.append(field.scenery.world.pose) or arrived(field))
    assert min(np.hypot(x - 4.0, y - 2.0) for x, y, _ in passed) < 0.3
    assert field.scenery.world.pose == pytest.approx((4.0, 4.0, 1.57), abs=0.3)
    assert field.touched == {"moving": 0, "resting": 0}


def test_what_hardware_does_is_part_of_a_scene(field):
    drive, loop = Drivetrain(deadband_v=1.0, deadband_omega=2.0), ControlLoop(period=0.25)
    scenario = replace(field.scenery.scenario, drive=drive, loop=loop)
    slow = Session(scenario, SCENES)
    for _ in range(8):
        slow.tick()
    world = slow.scenery.world
    assert (world.time, slow.lasted) == (pytest.approx(2.0), pytest.approx(0.25))
    assert world.pose == pytest.approx((2.0, 2.0, 0.0))


def arrived(scene):
    return scene.navigator.status.state == "arrived"


def test_a_goal_is_added_to_those_that_there_are(field):
    ask(field, type="goals", goals=[[4.0, 2.0, None]])
    ask(field, type="goals", goals=[[4.0, 4.0, None]], more=True)
    goals = [tuple(goal) for goal in field.navigator.mission.goals]
    assert goals == [(4.0, 2.0, None), (4.0, 4.0, None)]
    for _ in range(18):
        ask(field, type="goals", goals=[[4.0, 4.0, None]], more=True)
    with pytest.raises(InputError, match="at most 20"):
        ask(field, type="goals", goals=[[4.0, 4.0, None]], more=True)


def test_goals_that_cannot_be_are_refused_and_change_nothing(field):
    for x, y in ((0.1, 0.1), (50.0, 2.0)):
        with pytest.raises(InputError, match=r"wall|map"):
            ask(field, type="goals", goals=[[x, y, None]])
    assert [tuple(goal)[:2] for goal in field.navigator.mission.goals] == [(12.5, 5.0)]
    ask(field, type="goals", goals=[])
    field.tick()
    assert field.navigator.status.state == "idle"


def test_a_painted_wall_is_found_by_the_lidar_alone_and_driven_round(field):
    ask(field, type="goals", goals=[[8.0, 2.0, None]])
    drive(field, 1.0)
    ask(field, type="stroke", points=[[5.0, 0.5], [5.0, 4.0]], radius=0.15)
    assert "obstacles" in [one["type"] for one in told(field)]
    drive(field, 60.0, lambda: arrived(field))
    assert field.touched == {"moving": 0, "resting": 0}
    assert len([one for one in told(field) if one["type"] == "plan"]) >= 2
    assert not field.scenery.scenario.grid.occupied[8, 20]
    ask(field, type="stroke", points=[[5.0, 0.5], [5.0, 4.0]], radius=0.3, erase=True)
    assert field.scenery.world.obstacles == ()


def test_the_journal_holds_what_a_stroke_changes(field):
    for k in range(60):
        x = 0.3 + 0.2 * k
        ask(field, type="stroke", points=[[x, 5.5], [x + 0.1, 9.0]], radius=0.05)
    many = len(field.scenery.world.obstacles)
    assert many > 50
    sizes = []
    for points in ([[5.0, 3.0]], [[5.05, 3.0]], [[5.05, 3.0]]):
        said = len(field.journal.entries)
        ask(field, type="stroke", points=points, radius=0.1)
        sizes.append(sum(map(len, field.journal.entries[said:])))
    assert 0 < max(sizes[:2]) < 2000
    assert sizes[2] == 0
    ask(field, type="stroke", points=[[0.3, 7.0], [12.0, 7.0]], radius=0.1, erase=True)
    shown, real = (
        shapely.union_all([shapely.Polygon(ring) for ring in rings])
        for rings in (shown_obstacles(told(field)), field.scenery.world.obstacles)
    )
    assert shown.symmetric_difference(real).area < 0.01


def test_nobody_is_painted_over(field):
    ask(field, type="walker", x=6.0, y=5.0, vx=0.0, vy=0.0)
    ask(field, type="stroke", points=[[1.0, 2.0], [3.0, 2.0]], radius=0.5)
    ask(field, type="stroke", points=[[6.0, 5.0]], radius=0.5)
    solid = shapely.union_all([shapely.Polygon(ring) for ring in field.scenery.world.obstacles])
    assert solid.area > 0.3
    assert solid.distance(shapely.Point(6.0, 5.0)) >= 0.25
    assert field.scenery.world.contact == ""
    drive(field, 1.0)
    assert field.touched == {"moving": 0, "resting": 0}


def test_the_scenes_own_obstacles_and_walkers_are_erased():
    scene = Session(io.load_scenario(SCENES["office"]), SCENES)
    count = len(scene.scenery.world.obstacles)
    ask(scene, type="stroke", points=[[4.4, 4.0]], radius=0.2, erase=True)
    assert len(scene.scenery.world.obstacles) == count - 1
    x, y = scene.scenery.world.movers[0]
    ask(scene, type="stroke", points=[[x, y]], radius=0.2, erase=True)
    assert np.isnan(scene.scenery.world.movers[0]).all()
    with pytest.raises(InputError, match="no moving obstacle 0"):
        ask(scene, type="push", mover=0, vx=0.5, vy=0.0)
    ask(scene, type="reset")
    assert len(scene.scenery.world.obstacles) == count
    assert np.isfinite(scene.scenery.world.movers[0]).all()


def test_walkers_are_put_in_pushed_and_turned_back_by_paint(field):
    ask(field, type="walker", x=6.0, y=7.0, vx=0.8, vy=0.0)
    drive(field, 1.0)
    assert field.scenery.world.movers[0] == pytest.approx((6.8, 7.0), abs=0.05)
    ask(field, type="push", mover=0, vx=0.0, vy=0.5)
    drive(field, 1.0)
    assert field.scenery.world.movers[0] == pytest.approx((6.8, 7.5), abs=0.05)
    ask(field, type="stroke", points=[[6.0, 8.5], [8.0, 8.5]], radius=0.1)
    highest = 0.0
    for _ in range(200):
        field.tick()
        highest = max(highest, field.scenery.world.movers[0][1])
    assert 7.7 < highest < 8.5 - 0.25


@pytest.mark.parametrize(
    ("x", "y", "says"), [(2.5, 2.0, "too near"), (0.1, 0.1, "no.*room"), (99.0, 2.0, "no.*room")]
)
def test_nobody_is_put_where_there_is_no_room(field, x, y, says):
    with pytest.raises(InputError, match=says):
        ask(field, type="walker", x=x, y=y, vx=0.1, vy=0.1)
    assert len(field.scenery.world.movers) == 0


def test_there_are_only_so_many_walkers(field, monkeypatch):
    monkeypatch.setattr(scenery, "MOST_WALKERS", 2)
    for y in (4.0, 5.0):
        ask(field, type="walker", x=6.0, y=y, vx=0.1, vy=0.1)
    with pytest.raises(InputError, match="2 walkers"):
        ask(field, type="walker", x=6.0, y=6.0, vx=0.1, vy=0.1)


def test_a_walker_who_runs_into_a_resting_robot_turns_away_and_it_goes_on(field):
    ask(field, type="goals", goals=[])
    drive(field, 0.5)
    ask(field, type="walker", x=4.0, y=2.0, vx=-1.0, vy=0.0)
    drive(field, 4.0)
    assert field.touched == {"moving": 0, "resting": 1}
    assert field.halted == ""
    assert field.scenery.world.movers[0][0] > 2.6
    ask(field, type="goals", goals=[[2.0, 4.0, None]])
    drive(field, 20.0, lambda: arrived(field))


def test_a_robot_in_something_that_stands_is_halted_until_the_reset(field):
    x, y, _ = field.scenery.world.pose
    box = np.array([[x, y], [x + 0.5, y], [x + 0.5, y + 0.5], [x, y + 0.5]])
    field.scenery.world.add_obstacle(box)
    field.tick()
    field.tick()
    assert "reset" in field.halted
    time = field.scenery.world.time
    field.tick()
    assert field.scenery.world.time == time
    ask(field, type="reset")
    assert field.halted == ""
    drive(field, 0.2)
    assert field.scenery.world.time == pytest.approx(0.2)


def test_settings_take_effect_at_once_and_stay_over_a_reset(field):
    ask(field, type="set", name="dwa.weights.vel", value=0.7)
    ask(field, type="set", name="dwa.omega_samples", value=40)
    ask(field, type="set", name="limits.v_max", value=0.3)
    ask(field, type="reset")
    config, robot = field.navigator.config, field.navigator.robot
    assert (config.dwa.weights.vel, config.dwa.omega_samples) == (0.7, 40)
    assert robot.limits.v_max == 0.3
    drive(field, 3.0)
    assert 0.2 < field.scenery.world.twist.v <= 0.3 + 1e-9
    shown = {one["name"]: one["value"] for one in told(field)[0]["sliders"]}
    assert shown["limits.v_max"] == 0.3
    assert set(shown) == set(sliders(field._made.robot))


def test_a_weight_keeps_what_was_seen_and_a_preset_the_goals(field):
    ask(field, type="goals", goals=[[8.0, 2.0, None]])
    drive(field, 2.0)
    navigator, number = field.navigator, field.journal.number
    ask(field, type="set", name="dwa.weights.dist", value=0.5)
    field.tick()
    assert field.navigator is navigator
    assert field.navigator.status.plan is not None
    assert field.journal.number == number
    ask(field, type="preset", preset="paper")
    assert field.navigator.config.dwa.weights.heading == 0.5
    drive(field, 60.0, lambda: arrived(field))
    assert field.scenery.world.pose[:2] == pytest.approx((8.0, 2.0), abs=0.3)


def test_each_preset_drives_and_shows_its_candidates(field):
    for preset in ("paper", "default"):
        ask(field, type="preset", preset=preset)
        drive(field, 1.0)
        assert len(field.navigator.status.choice.samples) > 20
        assert told(field)[0]["preset"] == preset


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [("dwa.weights.val", 1.0, "did you mean"), ("limits.v_max", 50.0, "legal is"),
     ("dwa.horizon", 0.0, "legal is"), ("period", 0.1, "unknown setting")],
)  # fmt: skip
def test_settings_that_cannot_be_change_nothing(field, name, value, says):
    before = field.navigator.config
    with pytest.raises(InputError, match=says):
        ask(field, type="set", name=name, value=value)
    assert field.navigator.config == before


def test_it_pauses_and_steps(field):
    ask(field, type="pause", paused=False)
    with pytest.raises(InputError, match="pause first"):
        ask(field, type="step")
    ask(field, type="pause", paused=True)
    assert field.paused
    ask(field, type="step")
    assert field.scenery.world.time == pytest.approx(session.PERIOD)


def test_a_scene_whose_robot_overlaps_a_wall_is_refused(field):
    with pytest.raises(InputError, match="overlaps a wall"):
        Session(replace(field.scenery.scenario, start=(0.4, 5.0, 0.0)), SCENES)


def test_a_scene_waits_for_its_first_goal_and_shows_what_is_set_meanwhile(field):
    assert field.paused
    assert json.loads(field.journal.frame)["time"] == 0.0
    ask(field, type="walker", x=6.0, y=7.0, vx=0.0, vy=0.0)
    assert len(json.loads(field.journal.frame)["movers"]) == 1
    ask(field, type="goals", goals=[])
    assert field.paused
    ask(field, type="goals", goals=[[4.0, 2.0, None]])
    assert not field.paused
    drive(field, 1.0)
    ask(field, type="pause", paused=True)
    ask(field, type="goals", goals=[[4.0, 4.0, None]])
    assert field.paused
    assert json.loads(field.journal.frame)["goals"] == [[4.0, 4.0, None]]
    ask(field, type="reset")
    assert field.paused


def test_scenes_are_changed(field):
    ask(field, type="scene", scene="crowd")
    assert told(field)[0]["name"] == "crowd"
    drive(field, 1.0)
    with pytest.raises(InputError, match="did you mean 'crowd'"):
        ask(field, type="scene", scene="crowds")


def test_a_page_that_joins_late_or_a_new_recording_knows_all(field, monkeypatch):
    monkeypatch.setattr(session, "RECORDED", 2.0)
    ask(field, type="stroke", points=[[4.0, 1.0], [4.0, 3.0]], radius=0.15)
    drive(field, 1.9)
    before, number = told(field), field.journal.number
    drive(field, 0.5)
    after = told(field)
    assert field.journal.number > number
    known, now = shown_obstacles(before), after[0]["obstacles"]
    assert known
    assert np.allclose(known, now, atol=1e-4)
    assert {"scene", "seen", "plan"} <= {one["type"] for one in after}
    seen = [cell for one in before if one["type"] == "seen" for cell in one["cells"]]
    again = [cell for one in after if one["type"] == "seen" for cell in one["cells"]]
    assert {(r, c) for r, c, on in seen if on} & {(r, c) for r, c, on in again if on}
    episode = field.as_episode()
    assert episode.trajectory.times[0] == pytest.approx(0.0, abs=0.06)


def test_frames_are_small_and_finite(trap):
    drive(trap, 1.0)
    frame = json.loads(trap.journal.frame)
    assert frame["time"] == pytest.approx(0.95)
    assert len(trap.journal.frame) < 10_000
    assert frame["state"] == "following"


def test_what_is_saved_is_the_scene_as_it_stands(trap, tmp_path):
    ask(trap, type="stroke", points=[[3.0, 8.0], [5.0, 8.0]], radius=0.15)
    ask(trap, type="walker", x=4.0, y=2.0, vx=0.5, vy=0.0)
    ask(trap, type="set", name="limits.v_max", value=0.4)
    drive(trap, 3.0)
    loaded = io.load_scenario(io.save_scenario(trap.as_scenario(), tmp_path))
    world = World(loaded, trap.scenery.world.pose)
    assert loaded.start == pytest.approx(tuple(trap.scenery.world.pose))
    assert loaded.robot.limits.v_max == 0.4
    for _ in range(40):
        world.step(world.twist, 0.25)
        trap.scenery.world.step(trap.scenery.world.twist, 0.25)
        assert world.movers == pytest.approx(trap.scenery.world.movers, abs=1e-3)
        world.contact = trap.scenery.world.contact = ""
    solid = [shapely.union_all([shapely.Polygon(r) for r in one.obstacles])
             for one in (world, trap.scenery.world)]  # fmt: skip
    assert solid[0].symmetric_difference(solid[1]).area < 1e-6


def test_the_episode_is_what_was_driven(field, tmp_path):
    with pytest.raises(InputError, match="nothing has been driven"):
        field.as_episode()
    ask(field, type="goals", goals=[[4.0, 2.0, 0.5]])
    drive(field, 2.0)
    ask(field, type="walker", x=6.0, y=5.0, vx=0.5, vy=0.0)
    drive(field, 2.0)
    io.save_episode(field.as_episode(), tmp_path / "episode.npz")
    episode = io.load_episode(tmp_path / "episode.npz")
    assert len(episode.trajectory.times) == 80
    assert episode.goals.tolist() == [[4.0, 2.0, 0.5]]
    assert np.isnan(episode.movers[:40]).all()
    assert np.isfinite(episode.movers[40:]).all()
    assert len(episode.trace.candidate_rows) == 80
