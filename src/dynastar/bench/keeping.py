"""Episodes of missions kept as files: those that failed, and one that is run again."""

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dynastar.bench.missions import Mission, Options, Suite
from dynastar.bench.runner import Job, run_job
from dynastar.bench.selection import MOST
from dynastar.bench.statistics import succeeded
from dynastar.episode import Episode
from dynastar.errors import DynastarError, InputError
from dynastar.io.episode_file import save_episode


@dataclass(frozen=True)
class FailureKeeper:
    """Writes SUITE-NUMBER-REPEAT.npz and .png of each mission that failed into ``folder``."""

    folder: Path

    def __call__(
        self, suite: str, mission: Mission, repeat: int, episode: Episode, row: dict[str, Any]
    ) -> None:
        """Looks at a mission that was driven; warns if its files cannot be written."""
        if succeeded(row):
            return
        from dynastar.viewer.figure import draw_episode

        stem = f"{suite}-{mission.number}-{repeat}"
        try:
            save_episode(episode, self.folder / f"{stem}.npz")
            draw_episode(episode, self.folder / f"{stem}.png")
        except (DynastarError, OSError) as error:  # the mission's row stays what it is
            warnings.warn(f"{stem} was not saved: {error}", stacklevel=1)


def replay(
    name: str, suite: Suite, options: Options, number: int, repeat: int
) -> tuple[dict[str, Any], Episode]:
    """Runs one mission again as the suite runs it; its row and its episode.

    But for what was measured with a clock both are those of the first time. Raises InputError for a
    number that the suite does not have or leaves out, and for a mission that cannot be driven.
    """
    mission = mission_numbered(name, suite, options, number)
    episodes: list[Episode] = []
    job = Job(suite, mission, repeat, options.controller)
    row = run_job(options._replace(observe=lambda *seen: episodes.append(seen[3])), job)
    if not episodes:
        raise InputError(f"{name} {number} has no episode: {row['outcome']}, {row['reason']}")
    return row, episodes[0]


def mission_numbered(name: str, suite: Suite, options: Options, number: int) -> Mission:
    """The mission of a number; InputError if the suite does not have it, leaves it out, or drives none."""
    if not hasattr(suite, "scenario"):
        raise InputError(f"the suite {name} drives nothing: there is nothing to replay")
    missions = suite.missions(options._replace(select=str(number))) if number < MOST else ()
    mission = next((m for m in missions if m.number >= number), None)
    if mission is None or mission.number != number:
        raise InputError(f"the suite {name} has no mission {number}")
    if why := suite.leave_out(mission, options):
        raise InputError(f"the suite {name} leaves out mission {number}: {why}")
    return mission
