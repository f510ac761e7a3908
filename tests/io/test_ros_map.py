"""ROS maps: what nav2_map_server would read, what is written, and what is refused."""

import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from PIL import Image

from dynastar.errors import DynastarWarning, MapError
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.io import load_ros_map, save_ros_map

HEADER = {
    "image": "map.pgm",
    "resolution": 0.05,
    "origin": [-1.0, 2.0, 0.5],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}
PIXELS = np.array([[0, 254, 205], [255, 100, 128], [90, 1, 89], [166, 60, 101]], dtype=np.uint8)


def write(folder: Path, header: dict, image: bytes | np.ndarray = PIXELS) -> Path:
    if isinstance(image, np.ndarray) and str(header.get("image")).endswith(".png"):
        Image.fromarray(image).save(folder / header["image"])
    else:
        if isinstance(image, np.ndarray):
            image = b"P5 %d %d 255\n" % image.shape[::-1] + image.tobytes()
        (folder / str(header.get("image", "map.pgm"))).write_bytes(image)
    path = folder / "map.yaml"
    path.write_text(yaml.safe_dump(header))
    return path


def by_map_server(pixel: tuple[int, ...], header: dict) -> int:
    """One pixel (grey, or red, green, blue and perhaps alpha) as nav2_map_server's loop has it."""
    colours, alpha = list(pixel[:3]), pixel[3] if len(pixel) == 4 else None
    mode = header.get("mode", "trinary")
    if mode == "trinary" and alpha is not None:
        colours.append(alpha)
    shade = sum(colours) / len(colours) / 255
    occ = shade if header["negate"] else 1.0 - shade
    if mode == "raw":
        return round(shade * 255) if round(shade * 255) <= 100 else -1
    if mode == "scale" and alpha not in (None, 255):
        return -1
    if occ > header["occupied_thresh"]:
        return 100
    if occ < header["free_thresh"]:
        return 0
    if mode == "trinary":
        return -1
    low, high = header["free_thresh"], header["occupied_thresh"]
    return round((occ - low) / (high - low) * 100)


@pytest.mark.parametrize("mode", ["trinary", "scale", "raw"])
@pytest.mark.parametrize("negate", [0, 1])
@pytest.mark.parametrize("channels", [1, 3, 4])
def test_reads_pixels_as_map_server_does(tmp_path, mode, negate, channels):
    shape = (16, 16) if channels == 1 else (16, 16, channels)
    pixels = np.random.default_rng(channels).integers(0, 256, shape, dtype=np.uint8)
    if channels == 1:
        pixels = np.arange(256, dtype=np.uint8).reshape(16, 16)
    if channels == 4:
        pixels[::2, :, 3] = 255
    header = HEADER | {"image": "map.png", "mode": mode, "negate": negate}
    values = load_ros_map(write(tmp_path, header, pixels)).values
    for row in range(16):
        for column in range(16):
            pixel = tuple(int(p) for p in np.atleast_1d(pixels[15 - row, column]))
            assert values[row, column] == by_map_server(pixel, header), (row, column, pixel)


def test_first_image_row_has_the_largest_y_and_the_origin_its_yaw(tmp_path):
    grid = load_ros_map(write(tmp_path, HEADER))
    assert grid.values.tolist() == [[-1, 100, -1], [-1, 100, 100], [0, -1, -1], [100, 0, -1]]
    assert grid.frame == GridFrame(0.05, -1.0, 2.0, 0.5)


def test_a_plain_pgm_with_comments_reads_as_the_binary_one(tmp_path):
    plain = b"P2\n# drawn by hand\n3 4 # size\n255\n" + b" ".join(b"%d" % p for p in PIXELS.flat)
    expected = load_ros_map(write(tmp_path, HEADER)).values
    assert (load_ros_map(write(tmp_path, HEADER, plain)).values == expected).all()


@pytest.mark.parametrize("full", [1, 15, 100, 255, 256, 65535])
def test_a_pgm_of_any_depth_is_scaled_by_its_maximum(tmp_path, full):
    values = np.array([[0, full]], dtype=np.uint8 if full < 256 else ">u2")
    grid = load_ros_map(write(tmp_path, HEADER, b"P5 2 1 %d\n" % full + values.tobytes()))
    assert grid.values.tolist() == [[100, 0]]


@pytest.mark.parametrize("mode", ["1", "L", "LA", "P", "RGB", "RGBA", "I;16"])
def test_every_kind_of_png_shows_black_and_white(tmp_path, mode):
    grey = np.array([[0, 255], [255, 0]], dtype=np.uint8)
    image = Image.fromarray(grey).convert(mode)
    if mode == "I;16":
        image = Image.fromarray(grey.astype(np.uint16) * 257)
    path = write(tmp_path, HEADER | {"image": "map.png"})
    image.save(tmp_path / "map.png")
    assert load_ros_map(path).values.tolist() == [[0, 100], [100, 0]]


def test_numbers_without_a_point_before_the_exponent_are_numbers(tmp_path):
    path = write(tmp_path, HEADER)
    path.write_text(path.read_text().replace("0.05", "5e-2").replace("- 2.0", "- -1e-05"))
    assert load_ros_map(path).frame == GridFrame(0.05, -1.0, -1e-05, 0.5)


@pytest.mark.parametrize("image", ["map.pgm", "map.png"])
@pytest.mark.parametrize("negate", [0, 1])
def test_a_free_thresh_that_makes_the_unknown_free_is_told(tmp_path, image, negate):
    pixels = np.full((50, 50), 254, np.uint8)
    pixels[:10], pixels[20] = 205, 0
    pixels = 255 - pixels if negate else pixels
    header = HEADER | {"image": image, "negate": negate, "free_thresh": 0.25}
    path = write(tmp_path, header, pixels)
    says = r"map\.yaml: free_thresh 0\.25 makes .* unknown cells \((205|50)\) free, 20 % .* 0\.196"
    with pytest.warns(DynastarWarning, match=says):
        assert not (load_ros_map(path).values < 0).any()
    usual = write(tmp_path, header | {"free_thresh": 0.196}, pixels)
    assert (load_ros_map(usual).values < 0).sum() == 500


@pytest.mark.parametrize(
    ("change", "rows"), [({"mode": "raw"}, 40), ({"mode": "scale"}, 40), ({}, 0)]
)
def test_a_free_thresh_that_changes_nothing_is_not_told(tmp_path, change, rows):
    pixels = np.full((50, 50), 254, np.uint8)
    pixels[:rows], pixels[45, :20] = 205, 205
    load_ros_map(write(tmp_path, HEADER | {"free_thresh": 0.25} | change, pixels))


def any_grid(low: int = -1) -> st.SearchStrategy:
    shapes = hnp.array_shapes(min_dims=2, max_dims=2, max_side=9)
    some = st.one_of(st.sampled_from([-1, 0, 100]), st.integers(low, 100))
    values = st.one_of(
        hnp.arrays(np.int8, shapes, elements=some),
        hnp.arrays(np.int8, shapes, elements=st.sampled_from([-1, 0, 100])),
    )
    metres = st.floats(-1e6, 1e6)
    frames = st.builds(GridFrame, st.floats(1e-3, 1e2), metres, metres, st.floats(-7, 7))
    return st.builds(OccupancyGrid, values, frames)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(any_grid(), st.sampled_from(["pgm", "png"]), st.sampled_from(["trinary", "scale", "raw"]))
def test_what_is_saved_loads_back_the_same(tmp_path, grid, image, mode):
    path = tmp_path / "saved.yaml"
    if image == "pgm" and mode == "scale" and (grid.values < 0).any():
        with pytest.raises(MapError, match="png"):
            save_ros_map(grid, path, image, mode)
        return
    save_ros_map(grid, path, image, mode)
    loaded = load_ros_map(path)
    assert (loaded.values == grid.values).all()
    assert loaded.frame == grid.frame
    assert {p.suffix for p in tmp_path.iterdir()} <= {".yaml", ".pgm", ".png"}


def test_a_grid_with_masks_is_not_saved_without_them(tmp_path):
    grid = OccupancyGrid(np.zeros((2, 2), bool), keepout=np.ones((2, 2), bool))
    with pytest.raises(MapError, match="keepout"):
        save_ros_map(grid, tmp_path / "map.yaml")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"image": None}, "'image' is missing"),
        ({"resolution": None}, "'resolution' is missing"),
        ({"resolution": None, "resoluton": 1.0}, r"'resolution' is missing \(there is 'resoluton'"),
        ({"origin": None}, "'origin' is missing"),
        ({"negate": None}, "'negate' is missing"),
        ({"free_thresh": None}, "'free_thresh' is missing"),
        ({"occupied_thresh": None}, "'occupied_thresh' is missing"),
        ({"resolution": 0}, "'resolution' is 0"),
        ({"resolution": -0.05}, "'resolution' is -0.05"),
        ({"resolution": float("nan")}, "'resolution' is nan"),
        ({"resolution": float("inf")}, "'resolution' is inf"),
        ({"resolution": "small"}, "'resolution' is 'small'"),
        ({"resolution": True}, "'resolution' is True"),
        ({"resolution": 10**400}, "'resolution' is 1000"),
        ({"origin": [0, 0]}, "'origin' has 2 values"),
        ({"origin": [0, 0, 0, 0]}, "'origin' has 4 values"),
        ({"origin": 3}, "'origin' is 3"),
        ({"origin": [0, "a", 0]}, r"'origin\[1\]' is 'a'"),
        ({"origin": [0, float("nan"), 0]}, r"'origin\[1\]' is nan"),
        ({"origin": {"x": 0, "y": 0, "yaw": 0}}, "'origin' is"),
        ({"negate": 2}, "'negate' is 2"),
        ({"negate": "no"}, "'negate' is 'no'"),
        ({"occupied_thresh": 1.5}, "'occupied_thresh' is 1.5"),
        ({"free_thresh": -0.1}, "'free_thresh' is -0.1"),
        ({"free_thresh": 0.7}, "free_thresh 0.7 is above"),
        ({"mode": "ternary"}, "'mode' is 'ternary'"),
        ({"mode": 3}, "'mode' is 3"),
        ({"image": 7}, "'image' is 7"),
        ({"image": ""}, "'image' is ''"),
    ],
)
def test_a_wrong_header_says_what_is_wrong(tmp_path, change, message):
    header = {k: v for k, v in (HEADER | change).items() if v is not None}
    path = tmp_path / "map.yaml"
    path.write_text(yaml.safe_dump(header))
    with pytest.raises(MapError, match=f"map.yaml: .*{message}"):
        load_ros_map(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"", "empty"),
        (b"just words", "expected keys and values"),
        (b"- 1\n- 2\n", "expected keys and values"),
        (b"image: a\nimage: b\n", "twice"),
        (b"a: &x [1]\nb: *x\n", "aliases"),
        (b"image: [unclosed", "line 1"),
        (b"a: 1\n---\nb: 2\n", "not valid YAML"),
        (b"\x89PNG\r\n\x1a\n\x00\x00\xff", "not valid YAML"),
        (b"!!python/object/apply:os.system ['true']", "not valid YAML"),
        (b"resolution: " + b"9" * 5000, "not valid YAML"),
        (b"image: 2001-99-99", "not valid YAML"),
        (b"x: !!timestamp x", "not valid YAML"),
        (b"[" * 30000, "nested too deep"),
        (b"? [1, 2]\n: {}\n? {}\n: 1", "not valid YAML"),
        (b"a" * 300000, "at most"),
    ],
)
def test_what_is_no_yaml_table_is_refused(tmp_path, text, message):
    path = tmp_path / "map.yaml"
    path.write_bytes(text)
    with pytest.raises(MapError, match=message):
        load_ros_map(path)


@pytest.mark.parametrize(
    ("image", "message"),
    [
        (b"P5 3 4 255\n" + bytes(11), "ends after 11 of the 12"),
        (b"P5 3 4 255\n" + b"x" * 13, "1 bytes more"),
        (b"P5 3 4 100\n" + bytes([101] * 12), "outside 0 to 100"),
        (b"P5 3 4 0\n" + bytes(12), "maximum is 0"),
        (b"P5 3 4 70000\n" + bytes(24), "maximum is 70000"),
        (b"P5 0 4 255\n", "1 or more"),
        (b"P5 -3 4 255\n" + bytes(12), "header is broken"),
        (b"P5 3", "header is broken"),
        (b"P5 16385 16384 255\n", "at most 268435456"),
        (b"P5 999999999 999999999 255\n", "at most"),
        (b"P2 2 1 255\n1 2 3", "3 pixels where its header promises 2"),
        (b"P2 2 1 255\n1 -2", "digits"),
        (b"P2 2 1 255\n1 two", "digits"),
        (b"P2 2 1 255\n1 300", "outside 0 to 255"),
        (b"P2 2 1 255\n1 99999999999999999999999", "outside|cannot be read"),
        (b"P6 1 1 255\n123", "no PGM"),
        (b"GIF89a" + bytes(20), "no PGM"),
        (b"#!/bin/sh\n", "no PGM"),
        (b"", "empty"),
    ],
)
def test_a_wrong_image_says_what_is_wrong(tmp_path, image, message):
    with pytest.raises(MapError, match=f"map.pgm: .*({message})"):
        load_ros_map(write(tmp_path, HEADER, image))


def test_an_image_that_is_not_a_file_is_refused(tmp_path):
    path = write(tmp_path, HEADER | {"image": "map.pgm"})
    (tmp_path / "map.pgm").unlink()
    with pytest.raises(MapError, match="no such file"):
        load_ros_map(path)
    (tmp_path / "map.pgm").mkdir()
    with pytest.raises(MapError, match="a directory"):
        load_ros_map(path)
    with pytest.raises(MapError, match="no such file"):
        load_ros_map(tmp_path / "none.yaml")
    for name in ("/dev/zero", "a\\0b", "x" * 5000):
        path.write_text(yaml.safe_dump(HEADER).replace("map.pgm", f'"{name}"'))
        with pytest.raises(MapError):
            load_ros_map(path)


def resized_png(data: bytes, columns: int, rows: int) -> bytes:
    """The PNG with another size in its header, check sum included."""
    header = data[12:16] + struct.pack(">II", columns, rows) + data[24:29]
    return data[:12] + header + struct.pack(">I", zlib.crc32(header)) + data[33:]


@pytest.mark.parametrize("size", [(3, 3), (3, 5), (2, 4), (4, 4), (6, 2), (0, 4), (20000, 20000)])
def test_a_png_whose_header_lies_about_its_size_is_refused(tmp_path, size):
    path = write(tmp_path, HEADER | {"image": "map.png"})
    image = tmp_path / "map.png"
    image.write_bytes(resized_png(image.read_bytes(), *size))
    with pytest.raises(MapError, match=r"map\.png: "):
        load_ros_map(path)


@pytest.mark.filterwarnings("ignore:.*free_thresh:dynastar.errors.DynastarWarning")
@pytest.mark.parametrize("name", ["map.yaml", "map.pgm", "map.png"])
def test_no_truncation_and_no_flipped_byte_gives_anything_but_a_map_or_a_map_error(tmp_path, name):
    header = HEADER | {"image": "map.png" if name == "map.png" else "map.pgm"}
    path, victim = write(tmp_path, header), tmp_path / name
    whole, values = victim.read_bytes(), load_ros_map(path).values
    messages = []
    broken = [whole[:k] for k in range(len(whole))]
    broken += [
        whole[:k] + bytes([whole[k] ^ flip]) + whole[k + 1 :]
        for k in range(len(whole))
        for flip in (1, 16, 128, 255)
    ]
    for content in broken:
        victim.write_bytes(content)
        try:
            assert load_ros_map(path).values.size > 0
        except MapError as error:
            messages.append(str(error))
    assert len(messages) > len(whole) / 2
    assert all(tmp_path.name in message and "\n" not in message for message in messages)
    victim.write_bytes(whole)
    assert (load_ros_map(path).values == values).all()
    if name != "map.yaml":
        for k in range(len(whole)):
            victim.write_bytes(whole[:k])
            with pytest.raises(MapError):
                load_ros_map(path)


@pytest.mark.data
@pytest.mark.filterwarnings("ignore:.*free_thresh:dynastar.errors.DynastarWarning")
@pytest.mark.parametrize(
    ("name", "shape", "occupied", "unknown"),
    [
        ("depot", (307, 604), 0.032, 0.0),
        ("tb3_sandbox", (384, 384), 0.006, 0.941),
        ("turtlebot3_world", (384, 384), 0.005, 0.941),
        ("willow-2010-02-18-0.10", (608, 566), 0.002, 0.681),
        ("100by100_15", (2000, 2000), 0.149, 0.0),
    ],
)
def test_real_maps_load_and_load_back_after_saving(
    data_dir, tmp_path, name, shape, occupied, unknown
):
    grid = load_ros_map(data_dir / "ros_maps" / f"{name}.yaml")
    assert grid.values.shape == shape
    assert grid.occupied.mean() == pytest.approx(occupied, abs=5e-4)
    assert grid.unknown.mean() == pytest.approx(unknown, abs=5e-4)
    save_ros_map(grid, tmp_path / "again.yaml")
    again = load_ros_map(tmp_path / "again.yaml")
    assert (again.values == grid.values).all()
    assert again.frame == grid.frame


@pytest.mark.data
@pytest.mark.filterwarnings("ignore:.*free_thresh:dynastar.errors.DynastarWarning")
def test_every_node_of_the_depot_graph_is_free(data_dir):
    import json

    grid = load_ros_map(data_dir / "ros_maps" / "depot.yaml")
    graph = json.loads((data_dir / "ros_maps" / "depot_graph.geojson").read_text())
    nodes = [f for f in graph["features"] if f["geometry"]["type"] == "Point"]
    assert len(nodes) == 34
    for node in nodes:
        assert not grid.blocked()[grid.world_to_cell(*node["geometry"]["coordinates"][:2])]


@pytest.mark.data
def test_a_real_map_cut_anywhere_is_refused(data_dir, tmp_path):
    folder = data_dir / "ros_maps"
    (tmp_path / "depot.yaml").write_bytes((folder / "depot.yaml").read_bytes())
    whole = (folder / "depot.pgm").read_bytes()
    for k in range(0, len(whole), 4999):
        (tmp_path / "depot.pgm").write_bytes(whole[:k])
        with pytest.raises(MapError):
            load_ros_map(tmp_path / "depot.yaml")
