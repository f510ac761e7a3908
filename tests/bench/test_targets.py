import pytest

from dynastar.bench import targets
from dynastar.bench.report import report_targets
from dynastar.bench.table1 import RATIOS
from dynastar.bench.tables import as_markdown


def found(value, arrived=100, moving=0):
    figures = dict.fromkeys(("median", "mean", "p95", "worst"), value)
    ratios = dict.fromkeys(RATIOS, figures)
    kinds = {"all": ratios, "random": ratios}
    of_worlds = {"missions": 100, "arrived": arrived, "contacts_moving": moving}
    hybrid = {"length_ratio": figures, "turning_ratio": figures} if arrived else {}
    none = {"length_ratio": None, "turning_ratio": None}
    return {
        "table1": kinds,
        "table1_512": kinds,
        "table3": {**of_worlds, **(hybrid or none)},
        "table3_presets": dict.fromkeys(("default", "paper"), of_worlds),
    }


@pytest.mark.parametrize(("value", "outcome"), [(0.12, "met"), (1.2, "missed")])
def test_a_figure_up_to_its_target_meets_it(value, outcome):
    made = targets.table(found(value, 100 if outcome == "met" else 98, outcome == "missed"))
    assert len(made.rows) == len(targets.TARGETS) == 16
    assert {row[-1] for row in made.rows} == {outcome}


def test_what_nobody_arrived_for_is_blank_and_missed():
    made = targets.table(found(0.1, arrived=0))
    assert [row[2:] for row in made.rows[-2:]] == [(None, "missed")] * 2
    assert "| hybrid: length, median | 0.93 |  | missed |" in as_markdown(made)
    assert report_targets(found(0.1, arrived=0)).found["targets"][0]["measured"] == 0.1
