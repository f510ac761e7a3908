import pytest

from dynastar.errors import NoPath
from dynastar.geometry import Goal
from dynastar.navigator.mission import OVER, Mission

THERE, FURTHER = Goal(1.0, 2.0), Goal(3.0, 4.0)


def begun(*goals):
    mission = Mission()
    mission.begin(goals or (THERE,), "new goal")
    return mission


def test_a_mission_is_under_way_from_its_beginning_to_its_last_goal():
    mission = Mission()
    assert (mission.state, mission.under_way) == ("idle", False)
    mission.begin((THERE, FURTHER), "new goal")
    assert (mission.state, mission.reason, mission.under_way) == ("following", "new goal", True)
    mission.reach()
    assert (mission.goals, mission.under_way) == ([FURTHER], True)
    mission.reach()
    assert (mission.state, mission.goals, mission.under_way) == ("arrived", [], False)


def test_without_goals_it_is_idle():
    mission = begun()
    mission.begin((), "cancelled")
    assert (mission.state, mission.reason, mission.under_way) == ("idle", "cancelled", False)


def test_what_is_over_stays_over_until_the_next_begins():
    mission, error = begun(), NoPath("walled in")
    mission.block("no way is left", error)
    mission.say("following", "the path")
    mission.recover(3.0, "again")
    assert (mission.state, mission.reason, mission.error) == ("blocked", "no way is left", error)
    mission.begin((FURTHER,), "new goal")
    assert (mission.state, mission.error) == ("following", None)


@pytest.mark.parametrize("state", ["following", "waiting", "turning", *OVER])
def test_when_data_are_back_it_is_what_it_was(state):
    mission = begun()
    mission.state, mission.reason = state, "why"
    for fault in ("no scan for 0.4 s", "no scan for 0.5 s"):
        mission.lose(fault)
        assert (mission.state, mission.reason) == ("sensor_lost", fault)
    assert mission.regain()
    assert (mission.state, mission.reason) == (state, "why")
    assert not mission.regain()


def test_a_goal_given_while_data_are_missing_is_set_out_for_when_they_are_back():
    mission = begun()
    mission.block("no way is left")
    mission.lose("no scan yet")
    mission.begin((FURTHER,), "new goal")
    mission.lose("no scan yet")
    mission.regain()
    assert (mission.state, mission.goals) == ("following", [FURTHER])


def test_recoveries_are_counted():
    mission = begun()
    mission.recover(1.0, "look again")
    assert (mission.state, mission.reason, mission.recoveries) == ("recovering", "look again", 1)
