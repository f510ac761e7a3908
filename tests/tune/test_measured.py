"""Robots of known truth, driven in simulation and recorded: every estimate holds the truth."""

import math
import tomllib
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from driving import room
from dynastar import io
from dynastar.cli import main
from dynastar.errors import DataError
from dynastar.footprint import Footprint
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.robot import ROBOTS, Lidar, Limits, Robot
from dynastar.simulation import Noise, Scenario
from dynastar.simulation.imperfections import ControlLoop, Drivetrain, LidarDriver, Odometry, Post
from dynastar.tune.measured import measured, robot_toml
from dynastar.tune.recording import read_drive
from dynastar.tune.response import Onset, latency
from scripted_drive import by_hand, record

pytest.importorskip("rosbags")

LIMITS = Limits(0.6, 1.5, 0.5, 2.0, 0.8, 3.0, v_min=-0.6)
ROBOT = Robot("mine", LIMITS, Footprint.disc(0.25), Lidar(180, math.tau, 0.0, 6.0))
PLAIN = Scenario("plain", room(16.0, 12.0), ROBOT, (10.0, 6.0, 0.3), (Goal(6.0, 3.0),))
HARDWARE = replace(
    PLAIN,
    latency=0.12,
    drive=Drivetrain(gain_v=0.93, gain_omega=1.06, deadband_v=0.05, deadband_omega=0.12),
    noise=Noise(range_bound=0.03),
    lidar=LidarDriver(posts=(Post(2.0, 0.2, 3), Post(-1.0, 0.22, 1))),
)
SLOPPY = replace(
    PLAIN,
    latency=0.2,
    drive=Drivetrain(gain_v=1.1, latency_jitter=0.08, deadband_v=0.03, slip=0.0),
    odometry=Odometry(gain_v=0.9, gain_omega=1.1),
    noise=Noise(range_bound=0.01),
    lidar=LidarDriver(readings=(170, 190)),
    robot=replace(ROBOT, limits=LIMITS._replace(v_accel=1.5, v_brake=0.4, omega_accel=1.0)),
)
SLOW = {"slow_v": (0.02, 0.04, 0.06, 0.1), "slow_omega": (0.05, 0.1, 0.15)}


def truth_of(scenario):
    drive, odometry, limits = scenario.drive, scenario.odometry, scenario.robot.limits
    return {
        "latency": scenario.latency,
        "gain_v": drive.gain_v,
        "gain_omega": drive.gain_omega,
        "odometry_gain_v": odometry.gain_v,
        "odometry_gain_omega": odometry.gain_omega,
        "deadband_v": drive.deadband_v,
        "deadband_omega": drive.deadband_omega,
        "v_accel": limits.v_accel,
        "omega_accel": limits.omega_accel,
        "v_brake": limits.v_brake,
        "omega_brake": limits.omega_brake,
        "period": 0.05,
        "range_error": scenario.noise.range_bound,
        "beams": scenario.robot.lidar.beams,
    }


@pytest.fixture(scope="module")
def drives(tmp_path_factory):
    """Each scenario's recording and what it tells."""
    found = {}
    for scenario in (replace(PLAIN, latency=0.05), HARDWARE, SLOPPY):
        folder = tmp_path_factory.mktemp("drive") / "bag"
        record(folder, scenario, by_hand(0.5, 1.2, **SLOW), stamped=scenario is SLOPPY)
        found[len(found)] = scenario, folder, measured(read_drive(folder), scenario.robot)
    return found


@pytest.mark.parametrize("number", [0, 1, 2])
def test_every_parameter_is_within_its_stated_error(drives, number):
    scenario, _, found = drives[number]
    truth = truth_of(scenario)
    assert set(truth) == set(found.estimates)
    for name, true in truth.items():
        estimate = found.estimates[name]
        if name.startswith("deadband") and true == 0.0:
            assert not estimate.told, name
            continue
        if name == "range_error" and scenario is SLOPPY:  # no two scans have the same beams
            assert "no rest of 10 scans with the same beams" in estimate.evidence
            continue
        assert estimate.told, estimate.words()
        assert estimate.low - 1e-9 <= true <= estimate.high + 1e-9, (true, estimate.words())


@pytest.mark.parametrize("seed", range(2))
def test_noise_of_odometry_that_comes_often_moves_no_estimate_out_of_its_range(seed, tmp_path):
    """Between two messages the speed changes by less than the noise."""
    scenario = replace(HARDWARE, lidar=LidarDriver(), seed=seed)
    script = by_hand(0.5, 1.2, **SLOW)
    record(tmp_path / "bag", scenario, script, noise=0.004, per_command=5)
    found = measured(read_drive(tmp_path / "bag"), scenario.robot)
    for name, true in truth_of(scenario).items():
        estimate = found.estimates[name]
        if estimate.told:
            assert estimate.low - 1e-9 <= true <= estimate.high + 1e-9, (true, estimate.words())
    untold = {name for name, estimate in found.estimates.items() if not estimate.told}
    assert untold <= {"deadband_v", "deadband_omega"}


def test_a_slow_command_that_noise_hides_is_no_dead_band(tmp_path):
    record(tmp_path / "bag", PLAIN, by_hand(0.5, 1.2, **SLOW), noise=0.01)
    found = measured(read_drive(tmp_path / "bag"), ROBOT).estimates
    assert not found["deadband_v"].told
    assert "no command that clearly left the robot at rest" in found["deadband_v"].evidence


@pytest.mark.parametrize("bound", [0.1, 0.2])
def test_a_lidar_with_large_errors_is_told(bound, tmp_path):
    scenario = replace(PLAIN, start=(10.0, 3.0, 0.3), noise=Noise(range_bound=bound))
    record(tmp_path / "bag", scenario, [(0.0, 0.0, 5.0)])
    found = measured(read_drive(tmp_path / "bag"), ROBOT).estimates["range_error"]
    assert found.low <= bound <= found.high


def test_a_drive_that_nears_its_speed_gradually_still_tells_how_it_brakes(tmp_path):
    scenario = replace(PLAIN, drive=Drivetrain(lag=0.1))
    record(tmp_path / "bag", scenario, by_hand(0.5, 1.2, **SLOW), per_command=2)
    found = measured(read_drive(tmp_path / "bag"), ROBOT).estimates
    for name in ("v_accel", "v_brake", "omega_accel", "omega_brake"):
        assert found[name].low > 0.8 * found[name].value
        assert found[name].low <= truth_of(scenario)[name]


@pytest.mark.parametrize("number", [0, 1, 2])
def test_the_stated_errors_are_small_enough_to_use(drives, number):
    scenario, _, found = drives[number]
    for name, true in truth_of(scenario).items():
        estimate = found.estimates[name]
        if estimate.told and name not in ("period", "beams"):
            width = estimate.high - estimate.low
            allowed = {"latency": 0.15, "range_error": 0.05}.get(name, 0.3 * true)
            assert width <= allowed + 0.06 * name.startswith("deadband"), estimate.words()


def test_parts_of_the_robot_in_view_are_found(drives):
    scenario, _, found = drives[1]
    assert len(found.own) == 2
    posts = sorted(scenario.lidar.posts, key=lambda post: post.angle)
    for part, post in zip(sorted(found.own, key=lambda part: part.angle), posts, strict=True):
        assert part.angle == pytest.approx(post.angle, abs=math.tau / 180)
        assert part.distance == pytest.approx(post.distance, abs=0.01)
        assert part.readings == post.readings
    assert drives[0][2].own == drives[2][2].own == ()


def test_the_number_of_readings_varies(drives):
    beams = drives[2][2].estimates["beams"]
    assert (beams.low, beams.high) == (170, 190)
    assert "varies" in beams.evidence


def test_the_file_is_a_robot_with_the_safe_ends(drives, tmp_path):
    scenario, _, found = drives[1]
    text = robot_toml(found, "bag")
    file = tmp_path / "robot.toml"
    file.write_text(text)
    robot, config = io.load_robot(file)
    assert robot.footprint.circumscribed == 0.25
    assert (robot.limits.v_max, robot.limits.v_min, robot.lidar.range_max) == (0.6, -0.6, 6.0)
    assert robot.limits.v_brake <= LIMITS.v_brake
    assert robot.limits.v_least >= scenario.drive.deadband_v
    assert scenario.latency <= config.latency <= scenario.latency + 0.06
    assert scenario.noise.range_bound <= config.range_error
    assert config.drive_error >= 0.06
    assert "# gain_v: 0.93" in text
    for name, estimate in found.estimates.items():
        assert f"# {name}: {estimate.words().partition(': ')[2]}" in text
    assert len(tomllib.loads(text)["lidar"]["posts"]) == 2
    assert "No recording tells: footprint" in text


def test_what_a_recording_lacks_is_said(tmp_path):
    record(tmp_path / "rest", PLAIN, [(0.0, 0.0, 2.0), (0.3, 0.0, 2.0)])
    found = measured(read_drive(tmp_path / "rest"))
    told = {name for name, estimate in found.estimates.items() if estimate.told}
    assert told == {"period", "range_error", "beams"}
    assert "1 changes of the command" in found.estimates["latency"].evidence
    text = robot_toml(found, "rest")
    assert "# latency: the recording cannot tell: it has" in text
    assert "is a guess" in text
    assert set(tomllib.loads(text)) == {"robot", "sensor", "navigator"}


def test_a_mission_of_the_navigator_tells_what_it_can(tmp_path):
    from dynastar.ros.recording import run_recorded

    scenario = replace(
        HARDWARE,
        robot=ROBOTS["pioneer3dx"],
        grid=room(),
        start=(1.0, 3.0, 0.0),
        goals=(Goal(7.0, 3.0),),
        lidar=LidarDriver(),
        loop=ControlLoop(),
        navigator={"period": 0.1, "drive_error": 0.1},
    )
    run_recorded(scenario, tmp_path / "bag")
    found = measured(read_drive(tmp_path / "bag"))
    assert found.robot.name == "pioneer3dx"
    truth = truth_of(scenario) | {"period": 0.1}
    for name, estimate in found.estimates.items():
        if estimate.told and not name.startswith("deadband"):
            assert estimate.low - 1e-9 <= truth[name] <= estimate.high + 1e-9, estimate.words()
    assert found.estimates["beams"].told


def test_the_command_writes_the_file_and_names_what_is_missing(drives, tmp_path, capsys):
    out = tmp_path / "robot.toml"
    assert main(["tune", "--bag", str(drives[1][1]), "--out", str(out)]) == 0
    assert "latency: 0.1" in capsys.readouterr().out
    assert "[robot.limits]" in out.read_text("utf-8")
    bag = str(drives[1][1])
    assert main(["tune", "--bag", bag, "--robot", "jackal", "--out", str(out)]) == 2
    assert f"--out {out}: is there already; name a new file" in capsys.readouterr().err
    out = tmp_path / "jackal.toml"
    assert main(["tune", "--bag", bag, "--robot", "jackal", "--out", str(out)]) == 0
    assert 'base = "jackal"' in out.read_text("utf-8")
    out = tmp_path / "other.toml"
    assert main(["tune", "--bag", bag, "--topic", "cmd_vel=/base/cmd", "--out", str(out)]) == 2
    assert "give --topic cmd_vel=TOPIC" in capsys.readouterr().err
    assert main(["tune", "--bag", bag, "--hours", "1", "--out", str(out)]) == 2
    assert "--hours goes with a search, not with --bag" in capsys.readouterr().err
    assert main(["tune", "--bag", bag, "--topic", "speed=/cmd_vel"]) == 2
    assert "NAME one of scan, odom, cmd_vel" in capsys.readouterr().err
    assert main(["tune", "--bag", bag, "--out", "-"]) == 2
    assert "--out -: expected a file" in capsys.readouterr().err
    with pytest.raises(DataError, match="no such recording"):
        read_drive(tmp_path / "nothing")


def test_without_a_robot_the_lidar_is_the_one_that_the_scans_tell_of(tmp_path):
    lidar = Lidar(181, math.pi, 0.2, 5.0)
    scenario = replace(PLAIN, robot=replace(ROBOT, lidar=lidar))
    record(tmp_path / "bag", scenario, by_hand(0.5, 1.2))
    drive = replace(read_drive(tmp_path / "bag"), robot=None)
    file = tmp_path / "robot.toml"
    file.write_text(robot_toml(measured(drive), "bag"))
    found = io.load_robot(file)[0].lidar
    assert (found.beams, found.range_min, found.range_max) == pytest.approx((181, 0.2, 5.0))
    assert found.fov == pytest.approx(math.pi)
    burger = ROBOTS["turtlebot3_burger"]  # tells the mount, not what the scans tell
    file.write_text(robot_toml(measured(drive, burger), "bag"))
    told = io.load_robot(file)[0].lidar
    assert told[:4] == pytest.approx(found[:4])
    assert told.mount == burger.lidar.mount


def test_a_drive_that_is_slower_than_told_is_not_declared_exact(tmp_path):
    slow = Drivetrain(gain_v=0.9, gain_omega=0.9)
    record(tmp_path / "bag", replace(PLAIN, drive=slow), by_hand(0.5, 1.2))
    found = measured(read_drive(tmp_path / "bag"), ROBOT)
    gains = [found.estimates[f"gain_{name}"] for name in ("v", "omega")]
    assert all(one.high < 1.0 for one in gains)
    file = tmp_path / "robot.toml"
    file.write_text(robot_toml(found, "bag"))
    error = io.load_robot(file)[1].drive_error
    for fast, slow in [(a.high, b.low) for a in gains for b in gains]:  # whichever is the faster
        assert (1.0 + error) / (1.0 - error) >= 0.9999 * fast / slow


def test_a_command_that_is_not_finite_is_named(drives, monkeypatch):
    from dynastar.tune import recording

    read, count = recording.twist_of, iter(range(10**9))

    def odd(message):
        twist = read(message)
        return twist._replace(v=math.nan) if next(count) == 7 else twist

    monkeypatch.setattr(recording, "twist_of", odd)
    found = measured(read_drive(drives[0][1]))
    assert any("is not finite" in line for line in found.left_out)


def test_what_a_robot_file_declares_and_no_recording_tells_is_kept(drives, tmp_path):
    mine, out = tmp_path / "mine.toml", tmp_path / "robot.toml"
    mine.write_text(
        '[robot]\nbase = "jackal"\n[navigator]\npose_error = 0.07\nscan_age = 0.5\n'
        "dwa = {weights = {risk = 11.0}}\nlocal_map = {narrowest = 0.03}\n"
    )
    words = ["tune", "--bag", str(drives[1][1]), "--robot", str(mine), "--out", str(out)]
    assert main(words) == 0
    config = io.load_robot(out)[1]
    assert (config.pose_error, config.scan_age) == (0.07, 0.5)
    assert (config.dwa.weights.risk, config.local_map.narrowest) == (11.0, 0.03)


def test_messages_that_cannot_be_used_are_named(drives, tmp_path, monkeypatch):
    from dynastar.tune import recording

    read = recording.scan_of

    def odd(message, mount, count=iter(range(10**9))):
        scan = read(message, mount)
        return replace(scan, ranges=scan.ranges[:0]) if next(count) == 3 else scan

    monkeypatch.setattr(recording, "scan_of", odd)
    found = measured(read_drive(drives[1][1]))
    assert found.left_out[0].startswith("of scan 1 message refused, the first since ")
    assert found.left_out[0] in found.words()


def test_what_no_robot_can_be_is_no_file(drives, tmp_path, capsys, monkeypatch):
    """Odometry that turns the other way than commanded."""
    from dynastar.tune import recording

    drive = read_drive(drives[0][1])
    twisted = replace(
        drive, twists=drive.twists * (1.0, -1.0), poses=drive.poses * (1.0, 1.0, -1.0)
    )
    monkeypatch.setattr(recording, "read_drive", lambda path, topics: twisted)
    out = tmp_path / "robot.toml"
    assert main(["tune", "--bag", str(drives[0][1]), "--out", str(out)]) == 2
    told = capsys.readouterr()
    assert "gain_omega: -1" in told.out
    assert f"{out} is not written" in told.err
    assert "'drive.gain_omega' is -1.0: legal is from 0.1 to 3" in told.err
    assert not out.exists()


def test_a_latency_is_never_longer_than_a_motion_is_waited_for():
    onsets = [Onset(0.02 * k, 0.02 * k + 0.03, 0.0) for k in range(48)]
    found = latency(onsets)
    assert 0.94 <= found.low <= found.high <= 1.0


def test_a_step_of_the_command_is_no_motion_by_itself(drives):
    for _, _, found in drives.values():
        assert np.isfinite([estimate.low for estimate in found.estimates.values()]).all()


def test_a_drive_that_lags_has_its_gain_or_none(tmp_path):
    """A speed that is still on its way after seconds is not the one that it would reach."""
    scenario = replace(PLAIN, drive=Drivetrain(gain_v=1.2, lag=0.8))
    record(tmp_path / "bag", scenario, by_hand(0.4, 1.0), noise=0.001)
    found = measured(read_drive(tmp_path / "bag"), ROBOT).estimates["gain_v"]
    assert not found.told or found.low <= 1.2 <= found.high


def test_commands_that_are_sent_on_a_change_have_no_period(drives):
    drive = read_drive(drives[0][1])
    changes = np.flatnonzero(np.abs(np.diff(drive.commands, axis=0)).max(axis=1) > 0.0) + 1
    few = replace(
        drive, command_times=drive.command_times[changes], commands=drive.commands[changes]
    )
    text = robot_toml(measured(few, ROBOT), "a recording")
    assert "Commands come every" in text
    assert "period" not in tomllib.loads(text)["navigator"]


def test_of_two_lidars_the_one_with_more_scans_is_measured(drives, tmp_path, monkeypatch):
    from dynastar.tune import recording

    read = recording.scan_of

    def odd(message, mount, count=iter(range(10**9))):
        if next(count) % 3 == 0:
            message.header.frame_id = "rear"
            return replace(read(message, mount), ranges=read(message, mount).ranges + 0.5)
        return read(message, mount)

    monkeypatch.setattr(recording, "scan_of", odd)
    found = measured(read_drive(drives[0][1]))
    assert found.estimates["range_error"].high < 0.1
    assert "another lidar has more scans" in found.left_out[0]


@pytest.mark.parametrize(("number", "loaded"), [(0, False), (0, True), (1, True), (2, False)])
def test_a_robot_of_forces_and_masses_stops_as_the_file_says(number, loaded, tmp_path):
    """MuJoCo: motors of limited torque, which follow the commanded speed after a while."""
    pytest.importorskip("mujoco")
    from dynastar.bench.suites.physics import BODIES, GENTLE, LATENCY
    from dynastar.bench.suites.physics_world import PhysicsWorld

    robot, body = BODIES[number]
    limits = robot.limits._replace(**GENTLE, v_min=-robot.limits.v_max)
    robot = replace(robot, limits=limits)
    scenario = replace(PLAIN, robot=robot, latency=LATENCY, noise=Noise(0.01))
    world = partial(PhysicsWorld, body=body, floor=0.9, loaded=loaded)
    fast = 0.8 * limits.v_max
    record(tmp_path / "bag", scenario, by_hand(fast, 0.8 * limits.omega_max), make_world=world)
    found = measured(read_drive(tmp_path / "bag"), robot).estimates
    for name in ("odometry_gain_v", "odometry_gain_omega", "period", "beams"):
        truth = truth_of(scenario)[name]
        assert found[name].low <= truth <= found[name].high, found[name].words()
    delay = LATENCY + body.response(loaded)
    assert found["latency"].low <= delay
    assert LATENCY <= found["latency"].high <= delay + 0.1
    driven = world(scenario, Pose2D(6.0, 6.0, 0.0), 0)
    for _ in range(60):
        driven.step(Twist(fast, 0.0), 0.05)
    speed, began = driven.twist.v, driven.pose.x
    assert found["gain_v"].low <= speed / fast <= found["gain_v"].high
    for _ in range(80):
        driven.step(Twist(0.0, 0.0), 0.05)
    stop = speed * found["latency"].high + 0.5 * speed**2 / found["v_brake"].low
    assert 0.45 * stop < driven.pose.x - began <= stop


def test_a_recording_with_too_few_messages_says_of_which(tmp_path):
    record(tmp_path / "bag", PLAIN, [(0.0, 0.0, 0.05)])
    with pytest.raises(DataError, match=r"fewer than two messages of 'scan' that can be used$"):
        read_drive(tmp_path / "bag")
