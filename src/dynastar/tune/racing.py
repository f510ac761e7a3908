"""Racing: a setting is compared with the best one on the worlds driven so far, and stopped if worse.

All settings drive the same worlds in the same order. A setting is stopped when it can no longer win, for
it has failed in more worlds than the best setting in all of them, or when Wilcoxon's signed-rank test
[Wilcoxon1945] on the differences of the losses, world by world, has p < 0.05 for worse.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from dynastar.tune.objective import FAILURE

FEWEST = 6  # worlds that the test needs: 1 / 2^6 < 0.05
WORSE = 0.05  # one-sided p


@dataclass(frozen=True)
class Raced:
    """The losses in the worlds that were driven, and why the setting was stopped, "" if it was not."""

    losses: tuple[float, ...]
    stopped: str

    @property
    def mean(self) -> float:
        """The mean loss in the worlds that were driven."""
        return sum(self.losses) / len(self.losses)


def race(
    worlds: int, batch: int, drive: Callable[[int], Sequence[float]], best: Sequence[float] | None
) -> Raced:
    """Drives worlds in batches until all are driven or the setting is stopped.

    ``drive(n)`` returns the losses in the first n worlds; ``best`` are those of the best setting in all
    worlds, None for the first setting, which is never stopped.
    """
    losses: Sequence[float] = ()
    while len(losses) < worlds:
        losses = drive(min(len(losses) + batch, worlds))
        why = "" if best is None else why_stopped(losses, best)
        if why and len(losses) < worlds:
            return Raced(tuple(losses), why)
    return Raced(tuple(losses), "")


def why_stopped(losses: Sequence[float], best: Sequence[float]) -> str:
    """Why a setting with these losses in the first worlds is given up, or ""."""
    failed, allowed = (sum(loss >= FAILURE for loss in one) for one in (losses, best))
    if failed > allowed:
        return f"{failed} failures, the best setting has {allowed} in all worlds"
    differences = [a - b for a, b in zip(losses, best, strict=False) if a != b]
    if len(differences) < FEWEST:
        return ""
    from scipy.stats import wilcoxon

    p = float(wilcoxon(differences, alternative="greater", method="approx").pvalue)
    return f"worse in {len(losses)} worlds (p = {p:.2g})" if p < WORSE else ""
