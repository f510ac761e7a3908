"""What ``dynastar bench`` prints beside the totals."""

from collections import Counter

from dynastar.bench.missions import Options
from dynastar.bench.runner import result_of
from dynastar.cli.bench_output import SHOWN_REASONS, print_result
from made_up_suite import suite


def test_it_says_why_missions_were_skipped_and_what_an_interval_is(capsys):
    reasons = Counter({"needs \x1bJuPedSim": 9, **{f"reason {n}": 1 for n in range(6)}})
    made = suite(lambda: range(3))
    print_result(result_of("made", made, Options(), [], reasons, {"wall_s": 1.0, "cpu_s": 1.0}))
    out = capsys.readouterr().out
    assert "skipped, not counted as missions: 9: needs \\x1bJuPedSim" in out
    assert out.count("skipped, not counted") == SHOWN_REASONS
    assert "and 2 more reasons" in out
    assert "95 % confidence (Wilson)" in out
