"""Tables of the pages that are made of the results of several parts, from made-up results."""

import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).parents[2] / "benchmarks"))
import results_tables as tables
from results_parts import parts
from results_targets import TARGETS, targets_table
from simulators_page import navground_times

PARTS = {part.name: part for part in parts()}
ARM = "| {} | 0.61 | 0.69 | 0.94 | 1.40 | 1.90 | |"


def row(number=0, outcome="arrived", time=10.0, moving=0, resting=0, **more):
    contacts = {"contacts_moving": moving, "contacts_resting": resting, "circles": 1}
    return {"number": number, "outcome": outcome, "time": time, **contacts, **more}


def result(succeeded=9, missions=10, moving=1, resting=0, **more):
    return {
        "succeeded": succeeded,
        "missions": missions,
        "contacts_moving": moving,
        "contacts_resting": resting,
        "succeeded_interval": [0.6, 0.98],
        "bumps": 3,
        "stops": 26,
        "score": 0.499,
        "time_ratio": 1.31,
        "mean_time": 11.84,
        "mean_within_0_2": 0.0023,
        "cpu_s": 140.2,
        "rows": [row()],
        "groups": {},
        **more,
    }


def lines(text):
    return text.splitlines()


def difficulties(easy, medium, hard, missions=40, at="", moving=(0, 0, 0)):
    of = zip(("easy", "medium", "hard"), (easy, medium, hard), moving, strict=True)
    return {name + at: result(succeeded, missions, hit) for name, succeeded, hit in of}


@pytest.fixture
def measured():
    """A made-up result of every part that the targets name."""
    found = {target.part: result() for target in TARGETS}
    ratios = {"expanded_ratio": (0.197, 0.8), "length_ratio_fast": (0.906, 1.06)}
    ratios["total_time_ratio"] = (0.694, 1.4)
    spreads = {name: {"median": m, "p95": p} for name, (m, p) in ratios.items()}
    return found | {
        "barn": result(150, 150, 0, score=0.4955),
        "dynabarn": result(groups=difficulties(40, 39, 33, moving=(0, 0, 2))),
        "dynabarn_slow": result(groups=difficulties(19, 12, 6, 20, " 0.5 m/s")),
        "crowdnav_variants": result(
            groups={"visible": result(199, 200), "square": result(10, 10), "ten": result(10)}
        ),
        "robots": result(197, 200, 0),
        "physics": result(49, 50, 0, 1),
        "office": result(
            40, 40, 0, rows=[row(time=87.0), row(time=91.94), row(outcome="timeout", time=300.0)]
        ),
        "table3": {"table3": {"missions": 1000, "arrived": 996, "contacts_moving": 1}},
        "table1": {"table1": {"all": spreads}},
    }


def test_a_target_is_met_or_missed_with_the_command_beside_it(measured):
    shown = {line.split(" | ")[0]: line for line in lines(targets_table(measured, PARTS))}
    assert len(shown) == len(TARGETS) + 2
    for first, rest in {
        "BARN, 150 worlds: arrived, score": (
            "`dynastar bench barn --seed 10000` | 99 %, 0.495 | 150 of 150 (98-100), 0.495 |"
        ),
        "DynaBARN: easy, medium, hard: crossed, moving contacts": (
            "`dynastar bench dynabarn --seed 10000` | 98, 96, 80 %; 1, 2, 6 % | 40 of 40 (91-100), 0; "
            "39 of 40 (87-100), 0; 33 of 40 (68-91), 2 |"
        ),
        "the same at 0.5 m/s: ahead of the best published": (
            "`dynastar bench dynabarn --select 1000::2 --seed 10000` | 78, 60, 28 % | "
            "19 of 20 (76-99); 12 of 20 (39-78); 6 of 20 (15-52): missed |"
        ),
        "MRPB: arrived, time over the bound": (
            "`dynastar bench mrpb --seed 10000` | all, 1.3 | 9 of 10 (60-98), 1.31, "
            "1 moving contact: missed |"
        ),
        "eight robots: rightly ended, contacts": (
            "`dynastar bench robots --seed 10000` | 98 %, 0 | 197 of 200 (96-99), no contact |"
        ),
        "the same in MuJoCo": (
            "`dynastar bench physics --seed 10000` | 98 %, 0 | 49 of 50 (90-100), "
            "1 contact at rest: missed |"
        ),
        "the demo's office, 40 seeds: arrived, contacts, mean and longest time": (
            "`dynastar bench office --missions 40 --seed 10000` | all, 0, 90 s, 110 s | "
            "40 of 40 (91-100), no contact, 11.8 s, the slowest 91.9 s |"
        ),
        "people who do not react": (
            "`dynastar bench people --missions 160 --select 0::4,1::4,2::4 --attention none --seed 10000` "
            "| 72 %, 10 % | 9 of 10 (60-98), 1 moving contact |"
        ),
        "worlds like the paper's: arrived, moving contacts": (
            "`dynastar paper table3` | 99 %, 0.3 % | 996 of 1000 (99-100), "
            "1 of 1000 (0-1) moving contacts |"
        ),
        "length, fast smoothing, over traditional A*, median and 95th percentile": (
            "`dynastar paper table1` | 0.95, 1.05 | 0.91, 1.06: missed |"
        ),
    }.items():
        assert shown[f"| {first}"] == f"| {first} | {rest}"


def test_a_difficulty_below_its_share_is_missed(measured):
    for hard, moving, missed in ((31, 2, ": missed"), (33, 3, ": missed"), (33, 2, "")):
        groups = difficulties(40, 39, hard, moving=(0, 0, moving))
        measured["dynabarn"] = result(groups=groups)
        [line] = [of for of in lines(targets_table(measured, PARTS)) if "DynaBARN" in of]
        assert line.endswith(f", {moving}{missed} |")


@pytest.mark.parametrize(
    ("result_", "said"),
    [
        (
            result(495, 500, 1, 4, mean_time=11.0),
            "495 of 500 (98-100), 1 moving contact, 4 contacts at rest, 11.0 s, 0.2 % |",
        ),
        (
            result(495, 500, 2, 3, mean_time=11.0),
            "2 moving contacts, 3 contacts at rest, 11.0 s, 0.2 %: missed |",
        ),
        (
            result(494, 500, 0, 6, mean_time=11.0),
            "494 of 500 (97-99), 6 contacts at rest, 11.0 s, 0.2 %: missed |",
        ),
        (result(500, 500, 0, 0, mean_time=11.1), "no contact, 11.1 s, 0.2 %: missed |"),
        (
            result(500, 500, 0, 0, mean_time=11.0, mean_within_0_2=0.06),
            "no contact, 11.0 s, 6.0 %: missed |",
        ),
    ],
)
def test_among_people_arrivals_moving_contacts_and_time_count(measured, result_, said):
    measured["crowdnav"] = result_
    [line] = [of for of in lines(targets_table(measured, PARTS)) if "`crowdnav`:" in of]
    assert line.endswith(said)


def test_the_slower_of_two_crowds_is_missed(measured):
    measured["crowd_late"] = result(100, 100, 2, time_ratio=1.35)
    measured["crowd_none"] = result(100, 100, 2, time_ratio=1.36)
    late, none = (of for of in lines(targets_table(measured, PARTS)) if "recorded crowds" in of)
    assert late.endswith("| 100 of 100 (96-100), 2 moving contacts, 1.35 |")
    assert none.endswith("| 100 of 100 (96-100), 2 moving contacts, 1.36: missed |")


def test_every_target_names_a_part():
    assert {target.part for target in TARGETS} <= set(PARTS)


def test_the_same_missions_are_shown_with_both_attentions():
    found = {f"{s}_{a}": result() for s in ("people", "crowd") for a in ("late", "none")}
    assert lines(tables.attention_table(found))[2:4] == [
        "| `people` | `none` | 9 of 10 (60-98) | 1 | 0 |  |  | 1.31 |",
        "| `people` | `late` | 9 of 10 (60-98) | 1 | 0 | 3 | 26 | 1.31 |",
    ]
    found["people_reactive"] = result(10, 10, 0)
    assert lines(tables.attention_table(found))[-1] == (
        "| `people` | they react | 10 of 10 (72-100) | 0 | 0 |  |  | 1.31 |"
    )


def test_the_published_rows_stand_beside_ours():
    found = {"crowdnav": result(495, 500, 1, 4), "crowdnav_orca": result(212, 500, 285)}
    told = [{**row(n, group="told"), "time": 9.0} for n in range(4)]
    found["crowdnav_variants"] = {"rows": [*told, row(5, "contact", moving=1, group="ten")]}
    shown = lines(tables.crowdnav_table(found))
    assert (
        shown[3]
        == "| ORCA, this suite, the same 500 cases | 0.424 | 0.381 to 0.468 | 0.570 | 11.8 |"
    )
    assert (
        shown[8]
        == "| navigator, by lidar, the same 500 cases | 0.990 | 0.977 to 0.996 | 0.010 | 11.8 |"
    )
    assert shown[9] == (
        "| navigator, told positions and velocities, 4 cases | 1.000 | 0.510 to 1.000 | 0.000 | 9.0 |"
    )
    assert shown[11] == (
        "The navigator succeeds in 495 of 500 (98-100); 1 moving contact, 4 contacts at rest. "
        "It is nearer than 0.2 m to somebody for 0.2 % of the time. These cases take 140 s of CPU time. "
        "There were 1 turns by more than 270 degrees."
    )


def test_every_variant_has_as_many_cases_and_the_first_ones():
    rows = [row(n, group=name) for name in tables.VARIANTS for n in (2, 1)]
    rows += [row(3, "contact", moving=1, group="circle")]  # one case more than the others
    rows[-2] = row(1, "timeout", group="orca")
    shown = lines(tables.variants_table({"a": {"rows": rows[:4]}, "b": {"rows": rows[4:]}}))
    assert shown[2] == "| `circle` | 2 of 2 (34-100) | 0 | 0 | 0 | 10.0 | 2 |"
    assert shown[-1] == (
        "| `orca`: ORCA in the robot's place, on the circle | 1 of 2 (9-91) | 0 | 0 | 1 | 10.0 | 2 |"
    )
    assert len(shown) == 2 + len(tables.VARIANTS)


def test_dynabarn_at_half_a_metre_a_second():
    touched = [row(contact_after_jump=True), row(contact_after_jump=False), row()]
    of = result(30, 60, 17, 13, groups=difficulties(18, 11, 1, 20, " 0.5 m/s"), rows=touched)
    shown = tables.slow_table({"dynabarn_slow": of})
    each = " | ".join(f"{share} (0.60-0.98)" for share in ("0.90", "0.55", "0.05", "0.50"))
    assert f"\n| navigator, 60 missions | {each} |\n" in shown
    assert shown.endswith(
        "The navigator had 17 moving contacts, 13 contacts at rest; 1 of them with a disc that had just "
        "jumped."
    )


def test_the_speed_of_a_suite():
    of = result(rows=[row(time=1000.0), row(time=540.0)], cpu_s=140.0)
    assert tables.speed({"barn": of}).startswith("BARN runs 11 times faster")
    assert "target 15: missed" in tables.speed({"barn": of})


def test_the_readmes_table():
    found = {"scoreboard": {"suites": {}, "others": {"pure_pursuit": {}, "kompass_dwa": {}}}}
    for name in tables.COMPARED.values():
        found["scoreboard"]["suites"][name] = result(39, 40, rows=[row(n) for n in range(40)])
        half = [row(n) for n in range(0, 40, 2)]
        found["scoreboard"]["others"]["pure_pursuit"][name] = result(13, 20, rows=half)
    found["scoreboard"]["others"]["kompass_dwa"]["barn"] = result(19, 20, rows=half)
    beside = {"HL": row(time=8.8), "ORCA": row(outcome="contact")}
    found |= {
        "barn": result(148, 150),
        "dynabarn": result(110, 120),
        "maps": result(98, 100),
        "people_late": result(147, 160),
        "people_reactive": result(297, 300),
        "people_none": result(94, 160),
        "people_none-orca": result(50, 160),
        "crowdnav": result(495, 500),
        "crowdnav_orca": result(212, 500),
        "navground": result(
            44, 48, rows=[row(beside=beside), row(beside={**beside, "ORCA": row()})]
        ),
    }
    arms = "\n".join(ARM.format(f"{arm}, fast smoothing") for arm in ("traditional", "improved"))
    found["table1"] = {"tables": {"table1-time": arms, "table1-length": arms}}
    shown = lines(tables.readme_table(found))
    assert shown[2] == (
        "| BARN: static clutter (1) | 20 of 20 (84-100); all missions: 148 of 150 | "
        "kompass DWA 19 of 20 (76-99), pure pursuit 13 of 20 (43-82) |"
    )
    assert shown[3].endswith("| pure pursuit 13 of 20 (43-82) |")
    assert "; all missions: 444 of 460 |" in shown[5]
    assert shown[6] == "| indifferent people (1) | 94 of 160 (51-66) | ORCA 50 of 160 (25-39) |"
    assert "| 495 of 500 (98-100), 11.8 s | ORCA 212 of 500 (38-47), 11.8 s; in print" in shown[7]
    assert shown[8].endswith("| HL 2 of 2 (34-100), 8.8 s; ORCA 1 of 2 (9-91), 10.0 s |")
    both = "0.69 (0.61-0.94), 0.69 (0.61-0.94)"
    assert shown[9].endswith(f" | {both} | traditional A* smoothed alike {both} |")


def test_the_times_of_navgrounds_behaviors():
    rows = [row(time=13.5, beside={"HL": row(time=8.8), "ORCA": row(time=10.3)})]
    assert navground_times(rows).startswith(
        "dynastar takes 13.5 s and these behaviors 8.8 to 10.3 s"
    )


def test_contacts_while_moving_are_counted_by_cause():
    hit = [("people_late", 5, "slowed"), ("people_late", 16, "hidden"), ("dynabarn", 9, "hidden")]
    rows = [{"part": part, "number": number, "cause": cause} for part, number, cause in hit]
    arms = {"table3-default": [row(7, resting=1)], "table3-paper": [row(8, resting=1)]}
    parts = {"contact_causes": {"rows": rows}, "office": {"rows": [row(3, resting=1), row(4)]}}
    parts["table3"] = {"rows": arms}
    head, _, *rest = lines(tables.causes_table(parts))
    rest, resting = rest[: len(tables.CAUSES)], rest[len(tables.CAUSES) :]
    assert head == "| who was hit | all | `people_late` | `dynabarn` |"
    assert "| was hidden until the robot could not stop any more | 2 | 16 | 9 |" in rest
    assert resting[-2:] == ["| `office` | 1 | 3 |", "| `table3` | 1 | 7 |"]
    assert sum(int(line.split(" | ")[1]) for line in rest) == len(hit)
