"""A suite whose missions are numbers and whose rows are made up."""

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

from dynastar.bench.missions import Mission, Options


def suite(numbers: Any, default: int | None = None, left_out: Any = ()) -> Any:
    def missions(options: Options) -> Iterator[Mission]:
        return (Mission(number, 2 * number) for number in numbers())

    def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
        if mission.number == 13:
            raise RuntimeError("unlucky")
        return {"outcome": "arrived", "length": float(mission.spec), "time": 1.0 + repeat}

    return SimpleNamespace(
        DEFAULT_MISSIONS=default,
        missions=missions,
        leave_out=lambda mission, options: "by rule" if mission.number in left_out else "",
        run_mission=run_mission,
    )
