"""Maps by suffix, and the forms without a header."""

import io
import pickle

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from dynastar.errors import DynastarWarning, MapError
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.io import load_map, load_ros_map, save_map
from dynastar.io.maps import map_files

GRID = OccupancyGrid.from_text("#.?\n...")


@pytest.mark.parametrize("name", ["a.yaml", "a.yml", "a.pgm", "a.png", "a.npy", "a.txt", "A.TXT"])
def test_every_form_loads_back_what_it_saved(tmp_path, name):
    save_map(GRID, tmp_path / name)
    loaded = load_map(str(tmp_path / name))
    assert (loaded.values == GRID.values).all()
    assert loaded.frame == GRID.frame


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    hnp.arrays(
        np.int8, hnp.array_shapes(min_dims=2, max_dims=2, max_side=9), elements=st.integers(-1, 100)
    )
)
def test_an_array_loads_back_the_same(tmp_path, values):
    save_map(OccupancyGrid(values), tmp_path / "a.npy")
    assert (load_map(tmp_path / "a.npy").values == values).all()


def test_arrays_of_any_order_and_of_bools(tmp_path):
    occupied = np.array([[True, False, False], [False, True, True]])
    for array in (occupied, np.asfortranarray(occupied)):
        np.save(tmp_path / "a.npy", array)
        assert (load_map(tmp_path / "a.npy").occupied == occupied).all()


@pytest.mark.parametrize("suffix", [".npy", ".txt", ".map"])
def test_forms_without_a_header_refuse_what_they_would_lose(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    with pytest.raises(MapError, match="resolution and origin"):
        save_map(OccupancyGrid(np.zeros((2, 2), bool), GridFrame(0.05)), path)
    with pytest.raises(MapError, match="keepout"):
        save_map(OccupancyGrid(np.zeros((2, 2), bool), keepout=np.eye(2, dtype=bool)), path)
    if suffix != ".npy":
        with pytest.raises(MapError, match="only"):
            save_map(OccupancyGrid(np.full((2, 2), 50, np.int8)), path)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["a.jpg", "a", "a.yaml.gz"])
def test_an_unknown_suffix_lists_the_legal_ones(tmp_path, name):
    for call in (lambda: load_map(tmp_path / name), lambda: save_map(GRID, tmp_path / name)):
        with pytest.raises(MapError, match=r"\.yaml, \.yml, \.pgm, \.png, \.map, \.npy, \.txt"):
            call()


def test_an_image_needs_its_own_yaml_beside_it(tmp_path):
    save_map(GRID, tmp_path / "a.pgm")
    (tmp_path / "b.pgm").write_bytes((tmp_path / "a.pgm").read_bytes())
    with pytest.raises(MapError, match=r"expected b\.yaml"):
        load_map(tmp_path / "b.pgm")
    (tmp_path / "b.yaml").write_bytes((tmp_path / "a.yaml").read_bytes())
    with pytest.raises(MapError, match=r"another image, a\.pgm"):
        load_map(tmp_path / "b.pgm")


@pytest.mark.parametrize("load", [load_map, load_ros_map])
def test_an_image_stands_for_the_yaml_that_names_it(tmp_path, load):
    save_map(GRID, tmp_path / "a.pgm")
    (tmp_path / "a.yaml").rename(tmp_path / "home.yaml")
    (tmp_path / "goals.yaml").write_text("dock: [1.0, 2.0]\n")
    (tmp_path / "broken.yaml").write_text("image: b.pgm\nresolution: [\n")
    (tmp_path / "half.yaml").write_text("image: b.pgm\nresolution: 0.1\n")
    assert (load(tmp_path / "a.pgm").values == GRID.values).all()
    (tmp_path / "a.yaml").write_text(
        (tmp_path / "home.yaml").read_text().replace("a.pgm", "old.pgm")
    )
    assert (load(tmp_path / "a.pgm").values == GRID.values).all()
    (tmp_path / "other.yml").write_bytes((tmp_path / "home.yaml").read_bytes())
    with pytest.raises(MapError, match=r"several files .*: home\.yaml, other\.yml"):
        load(tmp_path / "a.pgm")


@pytest.mark.parametrize("name", ["a.jpg", "a"])
def test_other_names_of_a_map_hint_at_its_yaml(tmp_path, name):
    save_map(GRID, tmp_path / "a.yaml")
    with pytest.raises(MapError, match=r"there is .*a\.yaml beside it"):
        load_map(tmp_path / name)


def test_a_folder_of_maps_is_read_without_what_is_no_map(tmp_path):
    others = {
        "goals.yaml": "dock: [1.0, 2.0]\n",
        "graph.yaml": "- {from: 0, to: 1}\n",
        "broken.yaml": "a: [1\n",
    }
    for name, text in others.items():
        (tmp_path / name).write_text(text)
    with pytest.raises(MapError, match=r"no map .*broken\.yaml: .*goals\.yaml: the key 'image'"):
        map_files(tmp_path)
    for name in ("b.yaml", "a.yaml"):
        save_map(GRID, tmp_path / name)
    (tmp_path / "c.yaml").write_text("image: c.pgm\n")  # a map, though a broken one
    with pytest.warns(DynastarWarning) as told:
        found = map_files(tmp_path)
    assert [path.name for path in found] == ["a.yaml", "b.yaml", "c.yaml"]
    assert len(told) == len(others)
    assert all(name in str(said.message) for name, said in zip(sorted(others), told, strict=True))
    with pytest.raises(MapError, match="this is a folder") as error:
        load_map(tmp_path)
    assert "a.yaml" in str(error.value)
    assert "broken.yaml" not in str(error.value)


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (np.zeros((2, 2)), "float64"),
        (np.zeros((2, 2), np.uint8), "uint8"),
        (np.zeros(4, np.int8), "shape"),
        (np.zeros((0, 4), np.int8), "both > 0"),
        (np.full((2, 2), 101, np.int8), "-1 to 100"),
        (np.array([[None]]), "object"),
        (np.zeros((1, 1), [("a", "i1")]), "no array of numbers"),
    ],
)
def test_arrays_of_the_wrong_kind_are_refused(tmp_path, array, message):
    np.save(tmp_path / "a.npy", array)
    with pytest.raises(MapError, match=f"a.npy: .*{message}"):
        load_map(tmp_path / "a.npy")


def test_a_pickle_is_never_opened(tmp_path):
    (tmp_path / "a.npy").write_bytes(pickle.dumps({"no": "array"}))
    with pytest.raises(MapError, match="no NumPy array"):
        load_map(tmp_path / "a.npy")


def test_no_damage_to_an_array_gives_anything_but_a_map_or_a_map_error(tmp_path):
    path, stream = tmp_path / "a.npy", io.BytesIO()
    np.save(stream, GRID.values)
    whole = stream.getvalue()
    for k in range(len(whole)):
        path.write_bytes(whole[:k])
        with pytest.raises(MapError):
            load_map(path)
        for flip in (1, 4, 32, 128):
            path.write_bytes(whole[:k] + bytes([whole[k] ^ flip]) + whole[k + 1 :])
            try:
                assert load_map(path).values.size > 0
            except MapError:
                continue
    path.write_bytes(whole.replace(b"(2, 3)", b"(9, 9)"))
    with pytest.raises(MapError, match="6 bytes follow"):
        load_map(path)
    path.write_bytes(whole + b"more")
    with pytest.raises(MapError, match="10 bytes follow"):
        load_map(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"#.x\n", "line 1, column 3 of a drawn map is 'x'"),
        (b"\xff\xfe#.", "not UTF-8 text: save it as UTF-8"),
        (b"\n\n", "both > 0"),
        (b"", "empty"),
        (b"." * 20000 + b"\n." * 20000, "more than"),
    ],
)
def test_a_wrong_drawing_says_what_is_wrong(tmp_path, text, message):
    (tmp_path / "a.txt").write_bytes(text)
    with pytest.raises(MapError, match=f"a.txt: .*{message}"):
        load_map(tmp_path / "a.txt")


def test_a_map_that_is_not_there_or_cannot_be_written(tmp_path):
    for suffix in (".yaml", ".pgm", ".map", ".npy", ".txt"):
        with pytest.raises(MapError):
            load_map(tmp_path / f"none{suffix}")
        (tmp_path / f"folder{suffix}").mkdir()
        with pytest.raises(MapError):
            load_map(tmp_path / f"folder{suffix}")
        (tmp_path / "file").write_text("")
        with pytest.raises(MapError, match="cannot be written"):
            save_map(OccupancyGrid(np.zeros((2, 2), bool)), tmp_path / "file" / f"a{suffix}")
