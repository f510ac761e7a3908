"""The terms of Eq. 8 and their sum, Eq. 9, with the risk term.

G = alpha heading + beta dist + gamma vel + sigma simi - rho risk, where ``progress`` takes the place
of the paper's heading.
"""

import math

from dynastar.compiled import njit


@njit(cache=True)
def progress(gained, scale):
    """Decrease of the cost-to-go over a trajectory (m) over the most it could be (``scale``, m).

    At least -1: being driven off near the goal is no worse than anywhere else. No upper bound: near
    obstacles the cost-to-go falls by more than a metre a metre, and with an upper bound all
    manoeuvres score alike there, those that put driving off included.
    """
    return max(gained / scale, -1.0)


@njit(cache=True)
def dist(clearance, cap):
    """Dist term of Eq. 8: the clearance (m) up to ``cap``, from 0 to 1; negative inside the margin."""
    return min(clearance, cap) / cap


@njit(cache=True)
def vel(v, v_max):
    """Vel term of Eq. 8: the forward speed over the highest."""
    return v / v_max


@njit(cache=True)
def simi(strayed, cap):
    """Similarity of a trajectory to the global path: 1 - mean distance / cap, at least 0."""
    return 1.0 - min(1.0, strayed / cap)


@njit(cache=True)
def objective(weights, terms):
    """Eq. 9 with risk: G = alpha heading + beta dist + gamma vel + sigma simi - rho risk."""
    return (
        weights[0] * terms[0]
        + weights[1] * terms[1]
        + weights[2] * terms[2]
        + weights[3] * terms[3]
        - weights[4] * terms[4]
    )


@njit(cache=True)
def contact_probability(gap, spread):
    """Probability that two discs touch whose predicted gap (m) has a deviation of ``spread`` (m).

    The normal distribution's tail, by its logistic approximation.
    """
    return 1.0 / (1.0 + math.exp(1.702 * gap / spread))


@njit(cache=True)
def note_risk(people, k, t, x, y, radius, worst):
    """Raises ``worst`` (m, hypotheses): the highest discounted contact probability so far.

    The robot is a disc of ``radius`` at (x, y), ``t`` seconds from now, at step ``k``.
    """
    spread = people.spread[k]
    weight = math.exp(-t / people.memory)
    for m in range(len(people.now)):
        near = radius + people.now[m, 4]
        reach = near + 3.0 * spread
        for h in range(people.mean.shape[1]):
            dx, dy = people.mean[m, h, k, 0] - x, people.mean[m, h, k, 1] - y
            square = dx * dx + dy * dy
            if square < reach * reach:
                p = weight * contact_probability(math.sqrt(square) - near, spread)
                worst[m, h] = max(worst[m, h], p)


@njit(cache=True)
def risk(people, worst):
    """Expected number of contacts: the worst probability of each hypothesis, weighted."""
    total = 0.0
    for m in range(worst.shape[0]):
        for h in range(worst.shape[1]):
            total += people.weights[h] * worst[m, h]
    return total
