"""The ablation's arms, and what their rows add up to."""

import numpy as np
import pytest

from dynastar.bench import ablation, arms, paper, terms
from dynastar.bench.arms import ARMS, run_mission
from dynastar.bench.controllers.printed import Printed
from dynastar.bench.families import Map, draw
from dynastar.bench.follower import Follower
from dynastar.bench.missions import Mission, Options
from dynastar.bench.selection import choose_missions
from dynastar.bench.suites import people
from dynastar.bench.tables import as_text
from dynastar.bench.unplanned import Unplanned
from dynastar.navigator import PRESETS, configured
from dynastar.planning import HeuristicConfig, SearchGrid

DEFAULT = PRESETS["default"]


def settings(arm):
    return configured(ARMS[arm].preset, ARMS[arm].navigator)


def changed(config, base=DEFAULT, where=""):
    """The fields in which a config differs from another, by dotted name."""
    found = set()
    for name, value, other in zip(config._fields, config, base, strict=True):
        if hasattr(value, "_fields"):
            found |= changed(value, other, f"{where}{name}.")
        elif value != other:
            found.add(where + name)
    return found


def test_each_arm_differs_from_the_default_as_it_says():
    heuristic = "planner.heuristic."
    expected = {
        "default": set(),
        "printed": set(),
        "Eq. 2: k = 0": {heuristic + "k", "planner.exact"},
        "no exact improvement": {"planner.exact"},
        "Eq. 9: alpha = 0": {"dwa.weights.heading"},
        "Eq. 9: beta = 0": {"dwa.weights.dist"},
        "Eq. 9: gamma = 0": {"dwa.weights.vel"},
        "Eq. 9: weights as printed": {
            f"dwa.weights.{name}" for name in ("heading", "dist", "vel", "simi")
        },
        "no risk": {"dwa.weights.risk"},
        "no hysteresis": {"dwa.hysteresis"},
        "window of one period": {"dwa.reach"},
        "3 x 6 samples": {"dwa.v_samples", "dwa.omega_samples"},
        "10 x 22 samples": {"dwa.v_samples", "dwa.omega_samples"},
        "horizon 2 s": {"dwa.horizon"},
        "horizon 6 s": {"dwa.horizon"},
        "comfort 0.1 m": {"dwa.comfort"},
        "comfort 0.5 m": {"dwa.comfort"},
        "plans without comfort": {"comfort"},
        "deviation that does not grow": {"prediction.spread"},
        "bound without acceleration": {"prediction.acceleration"},
        "no people from unseen space": {"hidden_speed"},
        "no reverse": {"reverse"},
        "period 0.05 s": {"period"},
        "period 0.2 s": {"period"},
        "path following alone": set(),
    }
    assert {arm: changed(settings(arm)) for arm in expected} == expected
    for preset in PRESETS:
        assert settings(preset) == PRESETS[preset]
    others = {arm: ARMS[arm].controller for arm in ARMS if ARMS[arm].controller is not None}
    assert others == {
        "printed": Printed,
        "path following alone": Follower,
        "DWA alone": Unplanned,
    }
    for arm in (arm for arm in ARMS if arm.startswith("Eq. 2: ")):
        assert settings(arm)._replace(planner=DEFAULT.planner) == DEFAULT
        assert changed(settings(arm), settings(ARMS[arm].base)) <= {
            "planner.planner",
            *(heuristic + name for name in HeuristicConfig._fields),
        }
    assert {ARMS[arm].base for arm in ARMS if not arm.startswith("Eq. 2: ")} == {"default"}
    assert len({settings(arm) for arm in ARMS}) == len(ARMS) - len(others)


def test_of_eq_2_one_term_at_a_time_is_left_out():
    all_terms = HeuristicConfig()
    assert DEFAULT.planner.planner == "improved"
    assert DEFAULT.planner.heuristic == all_terms
    for arm in ("k = 0", "beta as interior angle", "Q as a line", "P / Q around n", "no h(p)"):
        config = settings(f"Eq. 2: {arm}").planner
        assert config.planner == "improved"
        assert len(changed(config.heuristic, all_terms)) == 1
    drawn = draw("rooms", 0)
    grid = SearchGrid(drawn.occupied)
    none = settings("Eq. 2: none of them (octile A*)").planner
    octile = grid.search(drawn.start, drawn.goal, none.planner, none.heuristic)
    exact = grid.search(drawn.start, drawn.goal, "dijkstra")
    assert octile.cost == pytest.approx(exact.cost)
    assert octile.expanded < exact.expanded


def row(number, arm, outcome="arrived", length=30.0, time=60.0, **more):
    return {
        "suite": "paper",
        "number": number,
        "arm": arm,
        "outcome": outcome,
        "length": length,
        "time": time,
        **more,
    }


ROWS = [
    row(0, "default"),
    row(0, "no reverse", length=33.0, time=90.0),
    row(2, "default", length=40.0, time=100.0),
    row(2, "no reverse", "blocked", 5.0, 50.0),
    row(4, "default", "contact", contacts_moving=1),
    row(4, "no reverse", length=50.0, time=90.0),
    row(5, "default", "timeout"),
    {"suite": "paper", "number": 5, "arm": "no reverse", "outcome": "error", "reason": "E: x"},
    row(6, "default", length=50.0, time=50.0),
    row(6, "no reverse", length=50.0, time=100.0),
    row(0, "default", suite="people"),
]


def test_a_summary_has_every_arm_of_each_suite_beside_its_base():
    found = ablation.summary(
        [*ROWS, row(0, "Eq. 2: k = 0"), row(0, "no exact improvement", time=30.0)]
    )
    assert list(found) == ["paper", "people"]
    assert list(found["paper"]) == [
        "default",
        "Eq. 2: k = 0",
        "no exact improvement",
        "no reverse",
    ]
    default, eq_2, not_exact, forward = found["paper"].values()
    assert (default["missions"], default["arrived"], default["contacts_moving"]) == (5, 3, 1)
    assert (default["time_ratio"], default["inert"]) == (1.0, True)
    assert (forward["lost"], forward["gained"], forward["time_ratio"]) == (1, 1, 1.75)
    assert (eq_2["time_ratio"], not_exact["time_ratio"]) == (2.0, 0.5)


def test_p_is_corrected_over_all_arms_but_the_default():
    # Of six worlds lost and none gained p is 2 / 2^6; three arms are compared.
    rows = [row(n, "default") for n in range(6)]
    rows += [row(n, "no risk", "timeout") for n in range(6)]
    rows += [row(n, arm) for n in range(6) for arm in ("no reverse", "no hysteresis")]
    found = ablation.summary(rows)["paper"]
    assert found["no risk"]["p"] == pytest.approx(2 / 64)
    assert found["no risk"]["p_holm"] == pytest.approx(3 * 2 / 64)
    assert found["no reverse"]["p_holm"] == 1.0


def test_the_tables_have_a_line_for_each_arm_by_its_effect():
    worse = [row(n, "no risk", "contact", contacts_resting=1) for n in (0, 2)]
    same = [{**of, "arm": "no hysteresis"} for of in ROWS[:-1:2]]
    of_paper, of_people = ablation.tables([*ROWS, *worse, *same])
    lines = {cells[0]: cells[6:] for cells in of_paper.cells[1:]}
    assert list(lines) == ["default", "no risk", "no reverse", "no hysteresis"]
    assert lines["default"] == [""] * 8
    assert lines["no risk"][:4] == ["2", "0", "1.000", "0"]
    assert lines["no reverse"][-2:] == ["1.750", "1.50 to 2.00"]
    assert lines["no hysteresis"][:3] == ["0", "0", "inert"]
    assert "5 worlds of the suite paper" in as_text(of_paper)
    assert len(of_people.cells) == 2


def test_rows_come_world_by_world_and_an_error_is_one(tmp_path, monkeypatch):
    def drive(scenario, navigator):
        assert scenario.seed == 7
        raise RuntimeError("no")

    monkeypatch.setattr(arms, "drive", drive)
    monkeypatch.setattr(ablation, "SUITES", ("paper",))
    rows = ablation.run(2, 7, tmp_path / "out")
    assert [row["arm"] for row in rows] == list(ARMS) * 2
    assert len({row["number"] for row in rows[: len(ARMS)]}) == 1
    assert {row["outcome"] for row in rows} == {"error"}
    monkeypatch.setattr(arms, "drive", None)
    assert ablation.run(2, 7, tmp_path / "out") == rows


def test_arms_drive_as_they_say():
    scenario = paper.world(0, 5)
    default = run_mission(scenario, ARMS["default"])
    suites = paper.run_mission(Mission(5), Options(), 0)
    assert default["length"] == suites["length"]
    follower = run_mission(scenario, ARMS["path following alone"])
    assert (follower["outcome"], follower["contacts_moving"]) == ("contact", 1)


def test_in_the_people_suite_an_arm_keeps_the_suites_own_settings():
    mission = choose_missions(people, Options(missions=1))[0][0]
    scenario = people.scenario(mission, Options(), 0)
    own = scenario.navigator["period"]
    seen = []

    def drive(scenario, navigator):
        seen.append(scenario.navigator)
        raise RuntimeError("no")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(arms, "drive", drive)
        run_mission(scenario, ARMS["no risk"], {"comfort": 0.2})
        run_mission(scenario, ARMS["period 0.2 s"])
    assert seen[0] == {**scenario.navigator, "comfort": 0.2, "dwa": {"weights": {"risk": 0.0}}}
    assert (own, seen[1]["period"]) == (0.05, 0.2)


def test_on_an_empty_map_all_terms_go_straight():
    found = terms.measure(Map("random", 0, np.zeros((9, 9), bool), (0, 0), (8, 8)))
    assert set(found) == {"kind", "number", *terms.ARMS}
    for arm in terms.ARMS:
        assert found[arm]["seconds"] > 0.0
        assert found[arm]["expanded"] >= 9
        if arm != "Eq. 2: beta as interior angle":  # which punishes the straight line
            assert found[arm]["length"] == pytest.approx(8 * np.sqrt(2))


def test_the_terms_are_measured_on_maps_of_each_kind(tmp_path):
    rows = terms.run(6, 0, tmp_path / "out", size=24)
    assert [row["kind"] for row in rows] == [kind for kind in terms.KINDS for _ in range(2)]
    found = terms.summary(rows)
    assert found["Euclidean A*"]["expanded_ratio"]["worst"] == 1.0
    assert found["octile A*"]["length_ratio"]["mean"] == pytest.approx(1.0)
    assert found["octile A*"]["expanded_ratio"]["worst"] <= 1.0
    assert found["weighted A*, w = 2"]["expanded_ratio"]["mean"] < 1.0
    assert found["weighted A*, w = 2"]["length_ratio"]["worst"] <= 2.0
    *by_kind, pool = terms.tables(rows)
    assert all(len(table.cells) == 1 + len(terms.ARMS) for table in (*by_kind, pool))
    assert by_kind[0].cells[0][1:] == list(terms.KINDS)
    assert by_kind[0].cells[1][1].startswith("1.000 (")
    before = (tmp_path / "out" / "terms.jsonl").read_text()
    assert terms.run(6, 0, tmp_path / "out", size=24) == rows
    assert (tmp_path / "out" / "terms.jsonl").read_text() == before
