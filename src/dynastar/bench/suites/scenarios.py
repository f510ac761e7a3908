"""Suite scenarios: the scenario files of a folder, in order of their names.

Each file is driven as it is: its own noise, latency, preset and settings. Files in subfolders count, and
a mission's group is its subfolder.
"""

import hashlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from dynastar.bench import driven
from dynastar.bench.missions import Mission, Options
from dynastar.errors import DataError
from dynastar.io.scenario_file import load_scenario
from dynastar.paths import local_path
from dynastar.simulation import Scenario

DEFAULT_MISSIONS = None
QUICK_MISSIONS = 20


def missions(options: Options) -> Iterator[Mission]:
    """One mission for each scenario file; the number is its place in the order of names."""
    folder = _folder(options)
    for number, file in enumerate(sorted(folder.rglob("*.toml"))):
        yield Mission(number, (file, file.parent.relative_to(folder)))


def leave_out(mission: Mission, options: Options) -> str:
    """Leaves nothing out."""
    del mission, options
    return ""


def scenario(mission: Mission, options: Options, repeat: int) -> Scenario:
    """The scenario of a file."""
    del options, repeat
    file, _ = mission.spec
    return load_scenario(file)


def source_of(mission: Mission) -> str:
    """Name and digest of a mission's file; the name alone where it cannot be read."""
    file, _ = mission.spec
    try:
        return f"{file} {hashlib.sha256(file.read_bytes()).hexdigest()}"
    except OSError:
        return str(file)


def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
    """Drives a scenario; its row also has the file's name."""
    file, group = mission.spec
    made = scenario(mission, options, repeat)
    row = driven.run_mission(made, options, mission, repeat, group=str(group))
    return {**row, "file": file.name, "preset": options.preset or made.preset}


def _folder(options: Options) -> Path:
    """The folder of scenario files: ``--data``, $DYNASTAR_DATA, or ``scenarios`` below either."""
    named = options.data or os.environ.get("DYNASTAR_DATA")
    if not named:
        raise DataError(
            "the suite scenarios reads scenario files: give the folder that holds them as --data DIR"
        )
    given = local_path(named, DataError)
    for folder in (given / "scenarios", given):
        if next(folder.rglob("*.toml"), None) is not None:
            return folder
    raise DataError(f"{named} holds no scenario file (.toml), nor does {named}/scenarios")
