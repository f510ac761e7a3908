"""Checking a robot before it drives: its numbers, the map, this computer and a recording."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dynastar.check import doors, driving, loop, promise
from dynastar.check.finding import Finding, Level, worst
from dynastar.check.passages import Passage
from dynastar.errors import InputError
from dynastar.grid import OccupancyGrid
from dynastar.navigator import NavigatorConfig
from dynastar.robot import Robot

if TYPE_CHECKING:
    from dynastar.check.recording import Recording


@dataclass(frozen=True)
class Check:
    """Result of a check: the findings, and what they were made from.

    ``passages`` are those of the map, narrowest first.
    """

    robot: Robot
    config: NavigatorConfig
    findings: tuple[Finding, ...]
    grid: OccupancyGrid | None = None
    passages: tuple[Passage, ...] = ()
    recording: "Recording | None" = None

    @property
    def level(self) -> Level:
        """The worst level of the findings."""
        return worst(*(finding.level for finding in self.findings))

    def as_data(self) -> dict[str, Any]:
        """The findings as plain data."""
        return {
            "level": self.level,
            "findings": [asdict(one) for one in self.findings],
            "passages": [asdict(one) for one in self.passages],
        }


def check_robot(
    robot: Robot,
    config: NavigatorConfig = NavigatorConfig(),
    grid: OccupancyGrid | None = None,
    bag: str | Path | None = None,
    remap: Mapping[str, str] | None = None,
    timed: bool = True,
) -> Check:
    """Checks a robot and the navigator's settings for it before it drives.

    ``grid`` is the map that it is to drive on, ``bag`` a recording of its scans and odometry, whose
    topics ``remap`` names by scan, odom and cmd_vel. ``timed`` measures a short simulated drive on this
    computer. Raises InputError for what is no robot, settings or map, and DataError for a recording
    that cannot be read.
    """
    kinds = (robot, Robot), (config, NavigatorConfig), (grid, OccupancyGrid | None)
    for given, kind in kinds:
        if not isinstance(given, kind):
            name = getattr(kind, "__name__", "OccupancyGrid or None")
            raise InputError(f"check_robot was given {given!r:.80}: expected {name}")
    recording = None
    if bag is not None:
        from dynastar.check.recording import read_recording

        recording = read_recording(bag, robot, config, remap)
    found: list[Passage] = []
    findings = [doors.widths(robot, config)]
    if grid is not None:
        found = doors.passages_for(robot, config, grid)
        findings.append(doors.doors(found, doors.ways_of(robot, config)))
    findings.append(doors.cells(robot, config, grid))
    parts = (
        *(driving.braking, driving.brakes, driving.beams, driving.blind_sectors, loop.delays),
        *(promise.at_rest, promise.moving, promise.hidden),
    )
    findings += [part(robot, config) for part in parts]
    if timed:
        findings.append(loop.loop(loop.tick_times(robot, config), config.period))
    if recording is not None:
        from dynastar.check.recorded import findings_of

        findings += findings_of(recording, robot, config)
    return Check(robot, config, tuple(findings), grid, tuple(found), recording)
