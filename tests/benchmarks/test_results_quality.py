"""Tables of how smoothly the robot drives and how near to people, from made-up results."""

import re
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2] / "benchmarks"))
import results_quality as tables


def row(outcome="arrived", **more):
    return {"outcome": outcome, **dict.fromkeys(tables.QUALITY, 1.0), **more}


def test_a_ratio_has_the_interval_of_the_pairs():
    pairs = [(2.0 * x, x) for x in (0.5, 1.0, 4.0)]
    assert tables._ratio(pairs) == "2.00 (2.00 to 2.00)"
    low, high = re.findall(r"[\d.]+|inf", tables._ratio([(1.0, 1.0), (3.0, 1.0)]))[1:]
    assert (low, high) == ("1.00", "3.00")
    assert tables._ratio([(1.0, 0.0), (1.0, 1.0)]).endswith(" to inf)")


def test_quality_is_compared_where_both_arrived():
    ours = [row(smoothness=0.8, nearest=None), row(smoothness=5.0)]
    other = [row(smoothness=0.5, circles=0), row("contact")]
    found = {"maps": {"rows": ours}, tables.MAPS_BESIDE: {"rows": other}}
    head, _, first, second, *rest = tables.quality_table(found).splitlines()
    assert head == (
        "| means of 1 missions | `navigator` | `pure_pursuit` | ratio (95 %) | at most 1.2 |"
    )
    assert first == "| `smoothness`, rad/s/m | 0.80 | 0.50 | 1.60 | missed |"
    assert second.endswith("| 1.00 | 1.00 | 1.00 | met |")
    assert "| `circles`, in a mission | 1.00 | 0.00 |  |  |" in rest
    assert "| `nearest`, m |  |  |  |  |" in rest


def test_the_interval_of_a_ratio_of_means_is_over_missions():
    ratio = tables._ratio([(1.0, 1.0)] * 50 + [(3.0, 1.0)] * 50)
    assert ratio == "2.00 (1.80 to 2.20)"


def test_nearness_is_of_the_missions_that_arrived():
    found = {"crowdnav": {"rows": [row(), row(nearest=2.0), row("contact", nearest=9.0)]}}
    head, _, line = tables.near_table(found).splitlines()
    assert head.startswith("| part | missions | nearest, m | under 0.2 m, % |")
    assert line.startswith("| `crowdnav` | 2 | 1.50 (1.00 to 2.00) | 100.0 (100.0 to 100.0) |")
