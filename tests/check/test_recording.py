"""Findings on recordings: real files with one thing wrong each, and none with nothing wrong."""

import math
from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from dynastar.check import check_robot
from dynastar.errors import DataError
from dynastar.geometry import Pose2D, Twist
from dynastar.navigator import configured
from dynastar.robot import ROBOTS, Lidar, slew
from dynastar.ros.bag import BagWriter, make
from recordings import ODOMETRY, OUT

ROBOT = replace(ROBOTS["pioneer3dx"], lidar=Lidar(360, math.tau, 0.1, 10.0))
DECLARED = {"latency": 0.1, "range_error": 0.03, "pose_error": 0.02, "heading_error": 0.01}
LATER = 0.4  # s after which the drive follows in a recording that is late
FRAMES = "odom", "base"


@dataclass
class Made:
    """What is written: ``scans`` and ``odometry`` are stamps (s), and what differs from a good one."""

    scans: list[float] = field(default_factory=lambda: [0.1 * k for k in range(80)])
    odometry: list[float] = field(default_factory=lambda: [0.1 * k for k in range(80)])
    age: float = 0.01
    beams: int = 360
    range_max: float = 10.0
    reading: float = 4.0
    v_max: float = 0.4
    follows_after: float = 0.1
    mount: Pose2D | None = Pose2D(0.0, 0.0, 0.0)
    clock: float = 0.0
    odd: str = ""  # one message that cannot be used
    rear: list[float] = field(default_factory=list)  # stamps of a second lidar

    def speed(self, time: float) -> float:
        """Commanded speed, m/s."""
        return self.v_max * (0.5 - 0.5 * math.cos(2.5 * time))

    def write(self, folder, topics=("/scan", "/odom", "/cmd_vel")):
        """Writes the recording and returns its folder."""
        events = [(t, "scan") for t in self.scans] + [(t, "odom") for t in self.odometry]
        events += [(t, "rear") for t in self.rear]
        events.sort(key=lambda event: event[0])
        with BagWriter(folder) as bag:
            if self.mount is not None:
                carried = OUT.transforms([("base", "laser", self.mount)], 0.0)
                bag.write("/tf_static", "tf2_msgs/msg/TFMessage", self.clock, carried)
            for time, kind in events:
                at = self.clock + time + self.age
                if kind in ("scan", "rear"):
                    frame = "laser" if kind == "scan" else "rear"
                    bag.write(topics[0], "sensor_msgs/msg/LaserScan", at, self._scan(time, frame))
                    continue
                twist = Twist(self.speed(time - self.follows_after), 0.0)
                message = OUT.odometry(Pose2D(0.1 * time, 0.0, 0.0), twist, FRAMES, time)
                bag.write(topics[1], ODOMETRY, at, message)
                command = OUT.twist(Twist(self.speed(time), 0.0))
                bag.write(topics[2], "geometry_msgs/msg/Twist", at, command)
            self._write_odd(bag)
        return folder

    def _write_odd(self, bag):
        if self.odd == "tf":
            wheel = OUT.transforms([("base", "wheel", Pose2D(math.nan, 0.0, 0.0))], 3.0)
            bag.write("/tf", "tf2_msgs/msg/TFMessage", 9.0, wheel)
        elif self.odd == "odometry":
            odd = OUT.odometry(Pose2D(0.3, 0.0, 0.0), Twist(math.nan, 0.0), FRAMES, 8.0)
            bag.write("/odom", ODOMETRY, 9.0, odd)
        elif self.odd == "command":
            bag.write("/cmd_vel", "geometry_msgs/msg/Twist", 9.0, OUT.twist(Twist(math.nan, 0.0)))
        elif self.odd == "scan":
            empty = self._scan(8.0)
            empty.ranges = np.empty(0, np.float32)
            bag.write("/scan", "sensor_msgs/msg/LaserScan", 9.0, empty)

    def _scan(self, time, frame="laser"):
        ranges = np.full(self.beams, 4.0, np.float32)
        ranges[: self.beams // 2] = self.reading
        return make(
            "sensor_msgs/msg/LaserScan",
            header=OUT.header(frame, time),
            angle_min=-math.pi,
            angle_increment=math.tau / self.beams,
            range_min=0.1,
            range_max=self.range_max,
            ranges=ranges,
        )


def findings(bag, remap=None, robot=ROBOT):
    """The findings on a recording by name."""
    check = check_robot(robot, configured("default", DECLARED), None, bag, remap, timed=False)
    return {one.name: one for one in check.findings if one.name.startswith("recorded")}


def test_nothing_is_wrong_with_a_recording_of_what_is_declared(tmp_path):
    found = findings(Made().write(tmp_path / "bag"))
    assert [one.words() for one in found.values() if one.level != "ok"] == []
    assert len(found) == 8
    assert found["recorded scans"].values["median_gap"] == pytest.approx(0.1)
    assert found["recorded stamps"].values["scans_age"] == pytest.approx(0.01, abs=1e-3)
    assert found["recorded readings"].values["beams"] == 360


@pytest.mark.parametrize("apart", [0.0, 0.02])
def test_two_lidars_are_two_streams(tmp_path, apart):
    found = findings(Made(rear=[0.1 * k + apart for k in range(80)]).write(tmp_path / "bag"))
    assert [one.words() for one in found.values() if one.level != "ok"] == []
    assert found["recorded scans"].values["median_gap"] == pytest.approx(0.1)


def test_a_lidar_that_stops_while_another_goes_on_is_found(tmp_path):
    found = findings(Made(rear=[0.1 * k for k in range(11)]).write(tmp_path / "bag"))
    assert found["recorded ranges"].level == "warning"
    assert "the lidar 'rear' is silent from 1.0 s on" in found["recorded ranges"].text.lower()


def test_beams_that_are_further_apart_than_declared_are_found(tmp_path):
    half = replace(ROBOT, lidar=Lidar(360, math.pi, 0.1, 10.0))  # as many, over half of the angle
    one = findings(Made().write(tmp_path / "bag"), robot=half)["recorded readings"]
    assert one.level == "problem"
    assert "declare beams = 360, fov = 6.26" in one.words()


def gap(first, last):
    """Stamps at 10 Hz without those between two times (s)."""
    return [0.1 * k for k in range(80) if not first < 0.1 * k < last]


@pytest.mark.parametrize(
    ("name", "level", "made", "said"),
    [
        ("recorded scans", "problem", Made(scans=gap(2.0, 3.0)), "1 of"),
        ("recorded scans", "problem", Made(scans=[0.5 * k for k in range(16)]), "2.0 times"),
        ("recorded scans", "warning", Made(scans=[0.2 * k for k in range(40)]), "scan_age = 0.4"),
        ("recorded odometry", "problem", Made(odometry=gap(2.0, 2.6)), "find what delays"),
        (
            "recorded stamps",
            "problem",
            Made(scans=[0.1 * k for k in range(80)] + [7.9]),
            "not rise",
        ),
        ("recorded stamps", "problem", Made(age=0.5), "clocks"),
        ("recorded stamps", "problem", Made(age=-0.3, clock=1.0), "0.700"),
        ("recorded stamps", "warning", Made(age=0.2), "delays the scans"),
        ("recorded readings", "problem", Made(beams=180), "beams = 180"),
        ("recorded readings", "problem", Made(range_max=6.0), "range_max = 6"),
        ("recorded mount", "problem", Made(mount=Pose2D(0.1, 0.0, 0.0)), "(0.100, 0.000)"),
        ("recorded ranges", "warning", Made(reading=0.0), "50 % of the lidar's readings are 0"),
        ("recorded ranges", "warning", Made(reading=0.2), "own footprint"),
        ("recorded speeds", "warning", Made(v_max=0.8), "0.80 m/s"),
        ("recorded speeds", "warning", Made(v_max=0.0), "rested"),
        ("recorded commands", "problem", Made(follows_after=LATER), "latency = 0."),
        ("recorded commands", "warning", Made(odometry=[0.25 * k for k in range(32)]), "period"),
    ],
)
def test_what_breaks_the_declared_settings_is_found(tmp_path, name, level, made, said):
    one = findings(made.write(tmp_path / "bag"))[name]
    assert (one.level, said in one.words()) == (level, True), one.words()


@pytest.mark.parametrize("commands_at", [0.02, 0.05, 0.25])
@pytest.mark.parametrize(("true", "told"), [(0.1, False), (0.4, True)])
def test_commands_in_steps_act_as_late_as_they_do(tmp_path, true, told, commands_at):
    """By hand: the drive takes 0.6 s to reach each; commands come more or less often than odometry."""
    speed, asked = 0.0, 0.0
    sent = []
    with BagWriter(tmp_path / "bag") as bag:
        for k in range(1600):
            now = 0.01 * k
            if k % round(100 * commands_at) == 0:
                asked = 0.5 if now % 4.0 < 2.0 else 0.0
                sent.append((now, asked))
                bag.write("/cmd_vel", "geometry_msgs/msg/Twist", now, OUT.twist(Twist(asked, 0.0)))
            acting = [v for at, v in sent if at <= now - true]
            speed = slew(speed, acting[-1] if acting else 0.0, 0.8, 0.8, 0.01)
            if k % 5 == 0:
                pose, twist = Pose2D(0.0, 0.0, 0.0), Twist(speed, 0.0)
                bag.write("/odom", ODOMETRY, now, OUT.odometry(pose, twist, FRAMES, now))
            if k % 10 == 0:
                bag.write("/scan", "sensor_msgs/msg/LaserScan", now, Made()._scan(now))
    robot = replace(ROBOT, limits=ROBOT.limits._replace(v_accel=0.8, v_brake=0.8))
    check = check_robot(
        robot, configured("default", DECLARED), None, tmp_path / "bag", None, timed=False
    )
    (one,) = (one for one in check.findings if one.name == "recorded commands")
    assert (one.values["latency"] is not None) == told, one.words()
    if told:
        assert one.values["latency"] == pytest.approx(true, abs=0.07)


def test_stamps_of_another_clock_are_not_judged(tmp_path):
    one = findings(Made(clock=1.7e9).write(tmp_path / "bag"))["recorded stamps"]
    assert one.level == "ok"
    assert "another clock" in one.text


def test_without_transforms_and_commands_it_says_so(tmp_path):
    bag = Made(mount=None).write(tmp_path / "bag", ("/scan", "/odom", "/other"))
    found = findings(bag)
    assert "No transform" in found["recorded mount"].text
    assert "No commands" in found["recorded commands"].text


def test_topics_of_other_names_are_found_or_named(tmp_path):
    bag = Made().write(tmp_path / "bag", ("/front/beams", "/robot/odom", "/cmd_vel"))
    with pytest.raises(DataError, match="no topic 'scan'"):
        findings(bag)
    assert findings(bag, {"scan": "/front/beams"})["recorded scans"].level == "ok"


def test_a_recording_without_scans_or_that_is_none_is_refused(tmp_path):
    with pytest.raises(DataError, match="has 1 scans: expected 2 or more"):
        findings(Made(scans=[0.0]).write(tmp_path / "bag"))
    with pytest.raises(DataError, match="no such recording"):
        findings(tmp_path / "none")
    (tmp_path / "text.mcap").write_text("no recording")
    with pytest.raises(DataError, match=r"text\.mcap"):
        findings(tmp_path / "text.mcap")


@pytest.mark.parametrize(
    ("what", "says"),
    [
        ("tf", "Of /tf 1 message refused, the first since the transform of the frame 'wheel'"),
        ("odometry", "Of odom 1 message refused, the first since the odometry is not finite"),
        ("scan", "Of scan 1 message refused"),
        ("command", "Of cmd_vel 1 message refused, the first since the command is not finite"),
    ],
)
def test_one_bad_message_is_named_and_the_rest_is_checked(tmp_path, what, says):
    found = findings(Made(odd=what).write(tmp_path / "bag"))
    assert says in " ".join(finding.words() for finding in found.values())
    assert found["recorded speeds"].level == "ok"
    assert "nan" not in found["recorded speeds"].text
