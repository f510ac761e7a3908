import pytest

from dynastar.navigator import NavigatorConfig
from dynastar.navigator.recovery import LASTING, STEPS, Recovery


def recovery(attempts=2):
    return Recovery(NavigatorConfig(attempts=attempts))


def test_the_gentlest_comes_first_and_in_the_end_it_gives_up():
    tried = recovery()
    steps = []
    while not tried.give_up():
        steps.append(tried.next(10.0 * len(steps), may_reverse=True))
    assert steps == [*STEPS, *STEPS]
    tried.reset()
    assert not tried.give_up()
    assert tried.next(0.0, True) == "turn"


def test_who_may_not_reverse_does_not_back_off():
    tried = recovery()
    steps = []
    while not tried.give_up():
        steps.append(tried.next(10.0 * len(steps), may_reverse=False))
    assert steps == ["turn", "forget", "replan"] * 2


@pytest.mark.parametrize(("step", "seconds"), LASTING.items())
def test_a_step_that_drives_does_so_for_a_while(step, seconds):
    tried = recovery()
    assert not tried.active(0.0)
    while tried.next(5.0, True) != step:
        pass
    assert tried.active(5.0 + seconds - 0.01)
    assert not tried.active(5.0 + seconds)
    assert tried.reason == f"recovery: {step}"


def test_forgetting_and_replanning_do_not_drive():
    tried = recovery()
    for _ in STEPS:
        if tried.next(5.0, True) not in LASTING:
            assert not tried.active(5.0)


def test_after_getting_on_for_long_the_rounds_count_anew():
    tried = recovery(attempts=1)
    tried.next(0.0, True)
    tried.progressed(1.0)
    tried.progressed(10.5)
    assert tried.next(11.0, True) == "back off"
    tried.progressed(12.0)
    tried.progressed(21.0)
    tried.progressed(22.5)
    assert tried.next(23.0, True) == "turn"


def test_without_a_way_it_forgets_now_and_then_and_each_costs_a_round():
    tried = recovery(attempts=2)
    allowed = [now for now in range(8) if tried.may_forget(float(now))]
    assert allowed == [0, 3, 6]
    assert tried.give_up()
    assert [now for now in range(8) if tried.may_replan(float(now))] == [0, 3, 6]
