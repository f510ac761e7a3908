"""The BARN data set [BARN]: Gazebo worlds of cylinders, and the official lengths of their paths.

A folder holds ``worlds.tar.xz`` with ``worlds/world_N.world`` and ``path_files/path_N.npy``.
"""

import io
import lzma
import math
import re
import tarfile
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

import numpy as np
import numpy.typing as npt

from dynastar.errors import DataError
from dynastar.io.files import read_bytes
from dynastar.io.npy import read_npy

ARCHIVE = "worlds.tar.xz"
START, GOAL = (-2.25, 3.0, math.pi / 2), (-2.25, 13.0)
MAX_ARCHIVE_BYTES = 256 * 2**20  # as stored
MAX_WORLD_BYTES = 16 * 2**20  # of one world
MAX_UNPACKED_BYTES = 2**30  # of all worlds
MAX_PATH_BYTES = 2**20

Floats = npt.NDArray[np.float64]

_FILE = re.compile(r"(?:.*/)?world_(\d{1,6})\.world")
_POSE = re.compile(r"\s*<static>1</static>\s*<pose[^>]*>\s*(\S+)\s+(\S+)\s")
_RADIUS = re.compile(r"<collision.*?<cylinder>\s*<radius>([^<]*)</radius>", re.DOTALL)


@lru_cache(maxsize=2)
def load_barn_worlds(folder: Path) -> Mapping[int, Floats]:
    """The cylinders (n, 3) of every world by number: x, y and radius in metres.

    Raises DataError for an archive that is damaged or too large, and for a world with a static
    model that is no cylinder, which this reader would leave out.
    """
    path = folder / ARCHIVE
    data = read_bytes(path, MAX_ARCHIVE_BYTES, DataError)
    worlds: dict[int, Floats] = {}
    unpacked = 0
    try:
        with tarfile.open(fileobj=io.BytesIO(data), mode="r:xz") as archive:
            for member in archive:
                name = _FILE.fullmatch(member.name)
                unpacked += member.size
                if unpacked > MAX_UNPACKED_BYTES:
                    raise DataError(f"{path}: more than {MAX_UNPACKED_BYTES} bytes when unpacked")
                if name is None or not member.isfile():
                    continue
                where = f"{path}, {member.name}"
                if member.size > MAX_WORLD_BYTES:
                    raise DataError(f"{where}: at most {MAX_WORLD_BYTES} bytes are read")
                file = archive.extractfile(member)
                assert file is not None
                text = file.read().decode("utf-8", errors="replace")
                worlds[int(name[1])] = read_barn_world(text, where)
    except (tarfile.TarError, lzma.LZMAError, EOFError, OSError) as error:
        raise DataError(f"{path}: cannot be unpacked ({error!s:.120})") from None
    if not worlds:
        raise DataError(f"{path}: holds no world_N.world")
    return dict(sorted(worlds.items()))


def read_barn_world(text: str, where: str) -> Floats:
    """The cylinders (n, 3) of a ``.world`` file: x, y and radius in metres; raises DataError."""
    found = []
    for model in text.partition("<state")[0].split("<model name='")[1:]:
        name, _, rest = model.partition("'>")
        body, end, _ = rest.partition("</model>")
        if not end:
            raise DataError(f"{where}: the model '{name:.40}' does not end")
        if name == "ground_plane":
            continue
        pose, radius = _POSE.match(body), _RADIUS.search(body)
        if pose is None or radius is None:
            raise DataError(f"{where}: the model '{name}' is no static cylinder with a pose")
        try:
            found.append((float(pose[1]), float(pose[2]), float(radius[1])))
        except ValueError:
            raise DataError(f"{where}: the model '{name}' has a pose or radius in words") from None
    cylinders = np.array(found, dtype=np.float64).reshape(-1, 3)
    if len(cylinders) == 0:
        raise DataError(f"{where}: holds no cylinder")
    if not (np.isfinite(cylinders).all() and (cylinders[:, 2] > 0.0).all()):
        raise DataError(f"{where}: expected finite positions and radii over 0")
    return cylinders


def official_length(folder: Path, number: int) -> float:
    """Metres of a world's official path, with start and goal put at its ends.

    The challenge places (row, column) at x = 0.15 row - 4.575, y = 0.15 column + 5.075, shifted
    against the obstacles, so this is for the length only. Raises DataError.
    """
    path = folder / "path_files" / f"path_{number}.npy"
    data = read_bytes(path, MAX_PATH_BYTES, DataError)
    try:
        cells = read_npy(data)
    except ValueError as error:
        raise DataError(f"{path}: {error}") from None
    if cells.ndim != 2 or cells.shape[1] != 2:
        raise DataError(f"{path}: has shape {cells.shape}, expected (n, 2) of row and column")
    line = np.vstack([START[:2], 0.15 * cells + (-4.575, 5.075), GOAL])
    length = float(np.hypot(*np.diff(line, axis=0).T).sum())
    if not math.isfinite(length):
        raise DataError(f"{path}: has a cell that is not finite")
    return length
