"""The admissible command that is nearest to one asked for, for a guard."""

from dynastar.compiled import inner, njit
from dynastar.dwa.admissible import ADMISSIBLE, certified_stop, refusal
from dynastar.dwa.motion import command_towards, state_of

PARTS = 8  # of the speeds asked for, from which the largest admissible fraction is looked for
HALVINGS = 3  # of the step between two parts


@njit(cache=True)
def nearest_admissible(around, rules, stops_from, twist, asked, steady):
    """The admissible command nearest to the speeds ``asked`` (v, omega) for.

    First along the arc asked for, as fast as admissible, then turning on the spot. Every command is
    one period's way from ``twist`` (v, omega). With ``steady`` (s), the robot speeds up only to what it
    could hold for so long. Returns whether there is a command, the command, and why the speeds asked
    for are refused, or ADMISSIBLE.
    """
    v, omega = asked
    found, command, why = fastest(around, rules, stops_from, twist, asked, steady)
    if not found and v != 0.0 and omega != 0.0:
        turn = 0.0, omega
        found, command, _ = fastest(around, rules, stops_from, twist, turn, steady)
    return found, command, why


@inner
def fastest(around, rules, stops_from, twist, asked, steady):
    """The command towards the largest admissible fraction of the speeds ``asked`` for.

    A robot that has to be ``steady`` and is slower than the least fraction starts with none below a part,
    so that the noise of its sensors does not start and stop it. Returns whether there is such a
    command, the command, and why the speeds asked for are refused, or ADMISSIBLE.
    """
    command, why = checked(around, rules, stops_from, twist, asked, steady)
    if why == ADMISSIBLE:
        return True, command, why
    (v, omega), (now_v, now_omega) = asked, twist
    best, step = 0.0, 1.0 / PARTS
    for part in range(PARTS - 1, 0, -1):
        fraction = part * step
        wanted = fraction * v, fraction * omega
        command, code = checked(around, rules, stops_from, twist, wanted, steady)
        if code == ADMISSIBLE:
            best = fraction
            break
    now, most = (now_v, v) if v != 0.0 else (now_omega, omega)
    starts = steady > 0.0 and abs(now) <= step * 0.5**HALVINGS * abs(most)
    if best > 0.0 or not starts:
        for _ in range(HALVINGS):
            step *= 0.5
            wanted = (best + step) * v, (best + step) * omega
            command, code = checked(around, rules, stops_from, twist, wanted, steady)
            if code == ADMISSIBLE:
                best += step
    command = command_towards(rules, twist, (best * v, best * omega))
    return best > 0.0 and command != (0.0, 0.0), command, why


@inner
def checked(around, rules, stops_from, twist, wanted, steady):
    """The command (v, omega) towards ``wanted`` speeds, and why it is refused, or ADMISSIBLE."""
    (v, omega), (now_v, now_omega) = command_towards(rules, twist, wanted), twist
    code = refusal(around, rules, stops_from, (v, omega))
    speeds_up = abs(v) > abs(now_v) or abs(omega) > abs(now_omega)
    if code == ADMISSIBLE and steady > 0.0 and speeds_up:
        begin = stops_from[-1]
        code = certified_stop(around, rules, state_of(begin), wanted, begin.hold + steady)
    return (v, omega), code
