"""``dynastar ros-goal``: sent to the navigator in the office, refused, and without any navigator."""

import subprocess

import pytest


def sent(processes, *words):
    """Exit status and output of the command."""
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    process = processes.start("ros-goal", *words, **options)
    output, _ = process.communicate(timeout=120)
    return process.returncode, output


@pytest.fixture
def logged(client, processes, tmp_path):
    """The office without a file that names it, its navigator ready for a goal, and the node's log."""
    log = tmp_path / "log"
    with log.open("w") as file:
        processes.start("ros-sim")
        processes.start("ros", "--scenario", "office", stderr=file, stdout=file)
        client.wait_for("no goal")
        yield log


def test_goals_are_sent_followed_and_refused(logged, client, processes):
    status, said = sent(processes, 5.0, 2.0)
    assert status == 0, said
    lines = said.splitlines()
    assert lines[:3] == ["waiting for the navigator's node", "sent (5, 2)", "accepted"]
    assert lines[3].startswith("following")
    assert lines[-1] == "arrived: the goal is reached"
    status, said = sent(processes, 700, 2)
    assert status == 1
    assert "the goal is refused" in said
    status, said = sent(processes, 4.0, 2.0, 1.57, "--frame", "odom")
    assert status == 1
    assert "expected 'map'" in said
    assert sent(processes, 4.0, 2.0, 1.57, "--no-wait") == (
        0,
        "waiting for the navigator's node\nsent (4, 2)\naccepted\n",
    )
    log = logged.read_text()
    assert "goal (5.00, 2.00)\n" in log
    assert "arrived: the goal is reached" in log
    assert "the goal is refused" in log
    assert "goal (4.00, 2.00) heading 1.57 rad" in log


def test_without_a_navigator_it_says_so(client, processes):
    status, said = sent(processes, 5.0, 2.0, "--timeout", 1)
    assert status == 1
    assert "no node takes goals after 1 s" in said


def test_markers_and_cost_to_go_are_published_live(office):
    from nav_msgs.msg import OccupancyGrid
    from visualization_msgs.msg import MarkerArray

    markers, costs = [], []
    office.node.create_subscription(MarkerArray, "markers", markers.append, 1)
    office.node.create_subscription(OccupancyGrid, "cost_to_go", costs.append, 1)
    office.set_off(7.2, 10.0)
    assert office.spin(10.0, lambda: len(markers) > 3 and len(costs) > 3)
    assert {one.ns for one in markers[-1].markers} >= {"robot", "candidates"}
    assert max(costs[-1].data) == 100
