"""ROS maps: map_server's YAML with a PGM or PNG image, as nav2_map_server reads and writes them.

An image shows light where the map is free. Shade is the mean of a pixel's colours from 0 to 1, and
occ = 1 - shade, or occ = shade with ``negate``. By mode:

- trinary: occ > occupied_thresh is occupied, occ < free_thresh free, anything else unknown. If the
  image has an alpha channel, alpha counts as one more colour (an old habit that map_server keeps).
- scale: the same ends, and 0 to 100 in proportion between them; what is not opaque is unknown.
- raw: a pixel of 0 to 100 (of 255) is the value itself, any other is unknown.
"""

import warnings
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt
import yaml

from dynastar.config import Field, checked, nearest
from dynastar.errors import ConfigError, DynastarWarning, MapError
from dynastar.grid import FREE, OCCUPIED, UNKNOWN, GridFrame, OccupancyGrid
from dynastar.io.files import MAX_BYTES, MAX_HEADER_BYTES, read_bytes
from dynastar.io.pgm import read_pgm, write_pgm
from dynastar.io.png import SIGNATURE, read_png, write_png
from dynastar.io.yaml_table import read_yaml
from dynastar.paths import local_path
from dynastar.writing import written_aside

Mode = Literal["trinary", "scale", "raw"]
_IMAGES = (".pgm", ".png")
USUAL_FREE_THRESH = 0.196  # just below the share of the grey of unknown cells
LEAST_UNKNOWN = 0.01  # share of the map from which cells of that grey are worth a warning
_TRINARY = {FREE: 254, OCCUPIED: 0, UNKNOWN: 205}  # the greys that map_saver writes
_UNKNOWN_SHARE = 1.0 - _TRINARY[UNKNOWN] / 255.0  # to which such a cell is occupied


class MapHeader(NamedTuple):
    """The YAML file's keys; all but ``mode`` have to be there, others are left alone."""

    image: Annotated[str, Field("the image, relative to the YAML file")]
    resolution: Annotated[float, Field("side of a cell", "m", 1e-4, 1e3)]
    origin: Annotated[
        tuple[float, float, float], Field("x, y (m), yaw (rad) of the lowest corner", "", -1e9, 1e9)
    ]
    negate: Annotated[Literal[0, 1], Field("whether dark means free")]
    occupied_thresh: Annotated[float, Field("occupied above this share", "", 0.0, 1.0)]
    free_thresh: Annotated[float, Field("free below this share", "", 0.0, 1.0)]
    mode: Annotated[Mode, Field("how a shade becomes a value")] = "trinary"


def load_ros_map(yaml_path: str | Path) -> OccupancyGrid:
    """The map of a map_server YAML file and its image, which has at most MAX_CELLS pixels.

    The name of an image stands for the YAML file beside it that names the image. Raises MapError
    with the file's name if anything is missing, malformed, cut off or lying. Warns where
    ``free_thresh`` makes the grey of unknown cells free.
    """
    path = local_path(yaml_path, MapError)
    if path.suffix.lower() in _IMAGES:
        path = _yaml_of(path)
    header = read_header(path)
    levels, full, opaque = _levels(_image_of(path, header), header.mode)
    values = _values_by_level(full, header)[levels]
    _check_unknown(path, header, levels, full)
    if header.mode == "scale" and opaque is not None:
        values[~opaque] = UNKNOWN
    return OccupancyGrid(values[::-1], GridFrame(header.resolution, *header.origin))


def not_a_map(path: Path) -> str:
    """Why a YAML file is no map at all, as one of named goals is not, or ""."""
    try:
        table = read_yaml(read_bytes(path, MAX_HEADER_BYTES, MapError), path)
    except MapError as error:
        return str(error)
    missing = [key for key in ("image", "resolution") if key not in table]
    return f"{path}: the key '{missing[0]}' is missing" if len(missing) == 2 else ""


def _image_of(path: Path, header: MapHeader) -> Path:
    """The image that a YAML file names."""
    return path.parent / local_path(header.image, MapError)


def _yaml_of(image: Path) -> Path:
    """The YAML file beside an image that names it, at best of the same name; raises MapError."""
    same = [image.with_suffix(suffix) for suffix in (".yaml", ".yml")]
    same = [table for table in same if table.is_file()]
    for table in same:
        if _names(table, image):
            return table
    naming = _other_tables(image, same)
    if len(naming) == 1:
        return naming[0]
    if naming:
        names = ", ".join(table.name for table in naming[:3])
        raise MapError(f"{image}: several files are for this image, name one of them: {names}")
    if same:
        named = _image_of(same[0], read_header(same[0])).name
        raise MapError(f"{image}: {same[0].name} beside it is for another image, {named}")
    raise MapError(
        f"{image}: an image alone has no resolution, expected {image.stem}.yaml beside it (ROS map)"
    )


def _other_tables(image: Path, same: list[Path]) -> list[Path]:
    """The other YAML files in the folder of an image that are for it; those that are broken are not."""
    found = []
    for table in sorted([*image.parent.glob("*.yaml"), *image.parent.glob("*.yml")]):
        with suppress(MapError):
            if table not in same and _names(table, image):
                found.append(table)
    return found


def _names(table: Path, image: Path) -> bool:
    """Whether a map's YAML file is for an image; raises MapError where it is broken."""
    return _image_of(table, read_header(table)).resolve() == image.resolve()


def read_header(path: Path) -> MapHeader:
    """The checked keys of a map's YAML file; raises MapError."""
    table = read_yaml(read_bytes(path, MAX_HEADER_BYTES, MapError), path)
    known = {key: table[key] for key in MapHeader._fields if key in table}
    others = [key for key in table if key not in known]
    for key in MapHeader._fields:
        if key not in known and key not in MapHeader._field_defaults:
            alike = [str(other) for other in others if key in nearest(str(other), [key])]
            hint = f" (there is '{alike[0]:.40}')" if alike else ""
            raise MapError(f"{path}: the key '{key}' is missing{hint}")
    try:
        header = checked(MapHeader, known)
    except ConfigError as error:
        raise MapError(f"{path}: {error}") from None
    if header.free_thresh > header.occupied_thresh:
        raise MapError(
            f"{path}: free_thresh {header.free_thresh:g} is above "
            f"occupied_thresh {header.occupied_thresh:g}"
        )
    if not header.image or "\0" in header.image:
        raise MapError(f"{path}: 'image' is {header.image!r:.80}, expected the name of a file")
    return header


def save_ros_map(
    grid: OccupancyGrid,
    yaml_path: str | Path,
    image: Literal["pgm", "png"] = "pgm",
    mode: Mode = "trinary",
) -> None:
    """Writes ``grid`` as a YAML file and, beside it under the same name, its image.

    What is written loads back the same: where a grid has values that ``trinary`` cannot hold
    (other than free 0, occupied 100, unknown -1), ``raw`` is written instead. ``scale`` keeps
    unknown cells in an alpha channel, so those need ``png``. Both files are complete before either
    gets its name. Masks are no part of a ROS map: a grid that has any is refused. Raises MapError.
    """
    path = local_path(yaml_path, MapError)
    if grid.keepout is not None or grid.speed_limit is not None:
        raise MapError(
            f"{path}: a ROS map cannot hold keepout or speed_limit, save it without them"
        )
    if mode == "trinary" and not np.isin(grid.values, list(_TRINARY)).all():
        mode = "raw"
    pixels = _image(grid, mode)
    if image == "pgm" and pixels.ndim == 3:
        raise MapError(
            f"{path}: unknown cells in mode 'scale' need image 'png', or take mode 'raw'"
        )
    image_path = path.with_suffix(f".{image}")
    thresholds = (1.0, 0.0) if mode == "scale" else (0.65, USUAL_FREE_THRESH)
    origin = tuple(float(number) for number in grid.frame[1:])
    values = (image_path.name, float(grid.resolution), origin, 0, *thresholds, mode)
    try:
        header = checked(MapHeader, dict(zip(MapHeader._fields, values, strict=True)))
    except ConfigError as error:
        raise MapError(f"{path}: {error}") from None
    table = header._asdict() | {"origin": list(header.origin)}
    with written_aside(path, MapError) as table_aside, written_aside(image_path, MapError) as aside:
        aside.write_bytes(write_pgm(pixels) if image == "pgm" else write_png(pixels))
        table_aside.write_text(
            yaml.safe_dump(table, sort_keys=False, default_flow_style=None), encoding="utf-8"
        )


def _levels(
    path: Path, mode: Mode
) -> tuple[npt.NDArray[np.unsignedinteger], int, npt.NDArray[np.bool_] | None]:
    """Brightness of every pixel as an integer, its largest value, and where the image is opaque."""
    data = read_bytes(path, MAX_BYTES, MapError)
    if data[:2] in (b"P2", b"P5"):
        return *read_pgm(data, path), None
    if not data.startswith(SIGNATURE):
        raise MapError(f"{path}: this is no PGM (P2, P5) and no PNG image")
    pixels = read_png(data, path)
    if pixels.ndim == 2:
        return pixels, int(np.iinfo(pixels.dtype).max), None
    opaque = pixels[:, :, 3] == 255 if pixels.shape[2] == 4 else None
    colours = pixels.shape[2] if mode == "trinary" else 3
    levels = np.zeros(pixels.shape[:2], np.uint16)
    for colour in range(colours):
        levels += pixels[:, :, colour]
    return levels, 255 * colours, opaque


def _check_unknown(
    path: Path, header: MapHeader, levels: npt.NDArray[np.unsignedinteger], full: int
) -> None:
    """Warns where ``free_thresh`` makes the grey free that map_saver writes for unknown cells."""
    if header.mode != "trinary" or header.free_thresh <= _UNKNOWN_SHARE:
        return
    occ = _occupancy(full, header)
    grey = np.abs(occ - _UNKNOWN_SHARE) < 0.5 / 255.0
    share = np.count_nonzero((grey & (occ < header.free_thresh))[levels]) / levels.size
    if share >= LEAST_UNKNOWN:
        level = 255 - _TRINARY[UNKNOWN] if header.negate else _TRINARY[UNKNOWN]
        words = (
            f"{path}: free_thresh {header.free_thresh:g} makes the grey of unknown cells "
            f"({level}) free, {100.0 * share:.3g} % of the map: the robot may plan through "
            f"what nobody has seen. With the usual free_thresh, {USUAL_FREE_THRESH}, they are unknown"
        )
        warnings.warn(words, DynastarWarning, stacklevel=3)


def _occupancy(full: int, header: MapHeader) -> npt.NDArray[np.float64]:
    """Share to which a cell is occupied for each brightness from 0 to ``full``."""
    shade = np.arange(full + 1) / full
    return shade if header.negate else 1.0 - shade


def _values_by_level(full: int, header: MapHeader) -> npt.NDArray[np.int8]:
    """Occupancy for each brightness from 0 to ``full``, int8 [full + 1]."""
    if header.mode == "raw":
        raw = np.floor(255.0 * np.arange(full + 1) / full + 0.5)
        return np.where(raw <= 100, raw, UNKNOWN).astype(np.int8)
    occ = _occupancy(full, header)
    between: Any = UNKNOWN
    if header.mode == "scale":
        span = header.occupied_thresh - header.free_thresh
        share = (occ - header.free_thresh) / max(span, 1e-9)
        between = np.rint(100.0 * np.clip(share, 0.0, 1.0))
    values = np.where(occ < header.free_thresh, FREE, between)
    return np.where(occ > header.occupied_thresh, OCCUPIED, values).astype(np.int8)


def _image(grid: OccupancyGrid, mode: Mode) -> npt.NDArray[np.uint8]:
    """Pixels, top row first: [rows, columns] grey, or [rows, columns, 2] grey and alpha."""
    values = grid.values[::-1]
    table = np.full(256, 255, dtype=np.uint8)  # by value as uint8, so that unknown is 255
    if mode == "trinary":
        table[list(_TRINARY)] = list(_TRINARY.values())
    elif mode == "raw":
        table[:101] = np.arange(101)
    else:
        table[:101] = np.rint(255.0 * (1.0 - np.arange(101) / 100.0))
    grey = table[values.view(np.uint8)]
    if mode != "scale" or (values != UNKNOWN).all():
        return grey
    return np.dstack([grey, np.where(values == UNKNOWN, 0, 255).astype(np.uint8)])
