"""An estimate with its evidence."""

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Estimate:
    """What a recording tells of a parameter: it lies between ``low`` and ``high``.

    ``value`` is None where the recording cannot tell; ``evidence`` then says what it lacks. ``n`` counts
    what the estimate is from.
    """

    name: str
    unit: str
    value: float | None
    low: float
    high: float
    n: int
    evidence: str

    @property
    def told(self) -> bool:
        """Whether the recording tells."""
        return self.value is not None

    def widened(self, share: float) -> "Estimate":
        """The same with a range that is wider by a share of the value, at either end."""
        more = share * abs(self.value or 0.0)
        return replace(self, low=self.low - more, high=self.high + more)

    def up_to(self, high: float, what: str) -> "Estimate":
        """The same with a range up to ``high`` at the least, because of ``what``."""
        if self.value is None or high <= self.high:
            return self
        return replace(self, high=high, evidence=f"{self.evidence}; up to {high:.2g} s for {what}")

    def words(self) -> str:
        """The estimate as a line of text."""
        unit = f" {self.unit}" if self.unit else ""
        if self.value is None:
            return f"{self.name}: the recording cannot tell: {self.evidence}"
        return (
            f"{self.name}: {self.value:.4g}{unit} ({self.low:.4g} to {self.high:.4g}), "
            f"n = {self.n}: {self.evidence}"
        )


def untold(name: str, unit: str, why: str, n: int = 0) -> Estimate:
    """An estimate of what the recording cannot tell."""
    return Estimate(name, unit, None, 0.0, 0.0, n, why)
