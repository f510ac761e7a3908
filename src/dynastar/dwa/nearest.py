"""The admissible command that is nearest to one asked for, for a guard."""

from dynastar.compiled import inner, njit
from dynastar.dwa.admissible import ADMISSIBLE, certified_stop, refusal
from dynastar.dwa.motion import command_towards, state_of

PARTS = 8  # of the speeds asked for, from which the largest admissible share is looked for
HALVINGS = 3  # of the step between two parts


@njit(cache=True)
def nearest_admissible(surroundings, rules, stops_from, twist, asked, steady):
    """The admissible command nearest to the speeds ``asked`` (v, omega) for.

    First along the arc asked for, as fast as admissible, then turning on the spot. Every command is
    one period's way from ``twist`` (v, omega). With ``steady`` (s), the robot speeds up only to what it
    could hold for so long. Returns whether there is a command, its v and omega, and why the speeds
    asked for are refused, or ADMISSIBLE.
    """
    found, v, omega, why = fastest(surroundings, rules, stops_from, twist, asked, steady)
    if not found and asked[0] != 0.0 and asked[1] != 0.0:
        turn = 0.0, asked[1]
        found, v, omega, _ = fastest(surroundings, rules, stops_from, twist, turn, steady)
    return found, v, omega, why


@inner
def fastest(surroundings, rules, stops_from, twist, asked, steady):
    """The command towards the largest admissible share of the speeds ``asked`` for.

    A robot that has to be ``steady`` starts with no share below a part, so that the noise of its
    sensors does not start and stop it. Returns whether there is such a command, its v and omega, and
    why the speeds asked for are refused, or ADMISSIBLE.
    """
    why, v, omega = checked(surroundings, rules, stops_from, twist, asked, steady)
    if why == ADMISSIBLE:
        return True, v, omega, why
    best, step = 0.0, 1.0 / PARTS
    for part in range(PARTS - 1, 0, -1):
        share = part * step
        wanted = share * asked[0], share * asked[1]
        code, v, omega = checked(surroundings, rules, stops_from, twist, wanted, steady)
        if code == ADMISSIBLE:
            best = share
            break
    starts = steady > 0.0 and (twist[0] if asked[0] != 0.0 else twist[1]) == 0.0
    if best > 0.0 or not starts:
        for _ in range(HALVINGS):
            step *= 0.5
            wanted = (best + step) * asked[0], (best + step) * asked[1]
            code, _, _ = checked(surroundings, rules, stops_from, twist, wanted, steady)
            if code == ADMISSIBLE:
                best += step
    v, omega = command_towards(rules, twist, (best * asked[0], best * asked[1]))
    return best > 0.0 and (v != 0.0 or omega != 0.0), v, omega, why


@inner
def checked(surroundings, rules, stops_from, twist, wanted, steady):
    """Why ``wanted`` speeds are refused, or ADMISSIBLE, and the command (v, omega) towards them."""
    v, omega = command_towards(rules, twist, wanted)
    code = refusal(surroundings, rules, stops_from, (v, omega))
    if (
        code == ADMISSIBLE
        and steady > 0.0
        and (abs(v) > abs(twist[0]) or abs(omega) > abs(twist[1]))
    ):
        begin = stops_from[-1]
        code = certified_stop(surroundings, rules, state_of(begin), wanted, begin.hold + steady)
    return code, v, omega
