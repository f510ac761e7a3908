"""Files that are damaged, or made to cost time and memory: refused in one sentence, cheaply."""

import io
import json
import lzma
import re
import struct
import subprocess
import sys
import tarfile
import zipfile
import zlib

import numpy as np
import pytest

from dynastar.bench.compare import load_result
from dynastar.errors import InputError
from dynastar.grid import OccupancyGrid
from dynastar.io import (
    load_episode,
    load_map,
    load_scenario,
    load_scenarios,
    save_episode,
    save_map,
)
from dynastar.io.barn import load_barn_worlds, official_length
from dynastar.io.dynabarn import load_dynabarn
from dynastar.io.mrpb import load_mrpb
from dynastar.io.pedestrians import load_recording
from episodes import episode

MEASURE = """
import json, resource, sys, time
from dynastar.errors import InputError
from dynastar.io import load_episode, load_map, load_scenario, load_scenarios
LOADERS = {".toml": load_scenario, ".scen": load_scenarios, ".npz": load_episode}
from pathlib import Path
import dynastar.io.scenario_file, PIL.PngImagePlugin
answers = []
for name in sys.argv[1:]:
    began = time.process_time()
    try:
        LOADERS.get(Path(name).suffix, load_map)(name)
        words = "read"
    except InputError as error:
        words = str(error)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    answers.append([Path(name).name, time.process_time() - began, peak, words])
print(json.dumps(answers))
"""


def png(columns, rows, colour=6, depth=8):
    """An image of zeros, packed a thousand to one."""
    packer = zlib.compressobj(9)
    row = bytes(1 + columns * {0: 1, 6: 4}[colour] * depth // 8)
    content = b"".join(packer.compress(row) for _ in range(rows)) + packer.flush()
    chunks = [(b"IHDR", struct.pack(">IIBBBBB", columns, rows, depth, colour, 0, 0, 0))]
    chunks += [(b"IDAT", content), (b"IEND", b"")]
    packed = [
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in chunks
    ]
    return b"\x89PNG\r\n\x1a\n" + b"".join(packed)


def zeros_npz():
    """An archive of 1 GB of zeros without a header."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        head = io.BytesIO()
        np.lib.format.write_array_header_1_0(
            head, {"descr": "|i1", "fortran_order": False, "shape": (2**30,)}
        )
        with archive.open("values.npy", "w", force_zip64=True) as member:
            member.write(head.getvalue())
            for _ in range(64):
                member.write(bytes(2**24))
    return stream.getvalue()


SCENARIO = 'robot = "pioneer3dx"\nstart = [0.5, 0.5]\ngoal = [1.5, 0.5]\n'
COSTLY = {
    "uneven.toml": lambda: (
        SCENARIO.encode() + b"[map]\nrows = ['" + 110_000 * b"." + b"'" + 36_000 * b", ''" + b"]\n"
    ),
    "dotted.toml": lambda: ".".join(120_000 * "a").encode() + b" = 1\n",
    "tables.toml": lambda: b"[" + ".".join(120_000 * "a").encode() + b"]\n",
    "nested.toml": lambda: b"a = " + 100_000 * b"[" + 100_000 * b"]",
    "wide.txt": lambda: 20_000_000 * b"." + b"\n" + 100_000 * b".\n",
    "spaces.pgm": lambda: b"P5" + 20_000_000 * b" " + b"1 1 255 ",
    "comments.pgm": lambda: b"P5\n" + 5_000_000 * b"#a\n" + b"1 1 255 ",
    "large.png": lambda: png(12_000, 12_000),
    "long.png": lambda: png(2**28 - 1, 1, 0),
    "rows.scen": lambda: b"version 1\n" + 400_000 * b"0\ta.map\t9\t9\t1\t1\t2\t2\t1.41421356\n",
    "zeros.npz": zeros_npz,
    "list.yaml": lambda: b"image: [" + 100_000 * b"1," + b"]\n",
    "keys.yaml": lambda: b"".join(b"k%d: 1\n" % n for n in range(25_000)),
    "array.npy": lambda: (
        b"\x93NUMPY\x01\x00v\x00"
        + b"{'descr': '|i1', 'fortran_order': False, 'shape': (True, 204), }".ljust(117)
        + b"\n"
        + bytes(204)
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", COSTLY)
def test_a_refusal_is_cheap(name, tmp_path):
    file = tmp_path / name
    file.write_bytes(COSTLY[name]())
    asked = [name]
    if name.endswith((".png", ".pgm")):
        header = {"image": name, "resolution": 0.05, "origin": [0.0, 0.0, 0.0], "negate": 0}
        header |= {"occupied_thresh": 0.65, "free_thresh": 0.2}
        (tmp_path / "map.yaml").write_text(json.dumps(header))
        asked = ["map.yaml"]
    command = [sys.executable, "-c", MEASURE, *asked]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    [[_, seconds, megabytes, words]] = json.loads(done.stdout)
    print(f"{name}: {seconds:.2f} s, {megabytes:.0f} MB, {words}")
    assert seconds < 10.0, words  # of the processor; the dearest takes 0.6
    assert megabytes < 1024.0, words
    assert words != "read"
    assert len(words) < 500


ODD = [b"nan", b"-inf", b"1e999", b"-1", b"0", b"9" * 30, b"0x10", b"true", b"null", b"[]", b"{}"]
ODD += [
    "\u00e9\u4e16".encode(),
    b"\xff\xfe",
    b"\0",
    b'"',
    b"'",
    b"#",
    b",",
    b":",
    b"=",
    b"\n",
    b"..",
    b"/",
]


def mutated(data, rng):
    """``data`` with one to three kinds of damage."""
    for _ in range(rng.integers(1, 4)):
        at = int(rng.integers(0, len(data) + 1))
        size = int(rng.integers(1, 40))
        piece = data[at : at + size]
        odd = ODD[rng.integers(len(ODD))]
        numbers = list(re.finditer(rb"[-+.\w]+", data))
        kind = rng.integers(6)
        if kind == 0:
            data = data[:at]
        elif kind == 1:
            data = data[:at] + bytes([rng.integers(256)]) + data[at + 1 :]
        elif kind == 2:
            data = data[:at] + piece + data[at:]
        elif kind == 3:
            data = data[:at] + data[at + size :]
        elif kind == 4 or not numbers:
            data = data[:at] + odd + data[at:]
        else:
            word = numbers[rng.integers(len(numbers))]
            data = data[: word.start()] + odd + data[word.end() :]
    return data


def header_of(name):
    return (
        f"image: {name}\nmode: trinary\nresolution: 0.05\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.25\n"
    ).encode()


def barn_archive():
    world = (
        b"<sdf><model name='ground_plane'></model><model name='unit_cylinder_0'><static>1</static>"
        b"<pose frame=''>-1.0 5.0 0 0 0 0</pose><link><collision><geometry><cylinder><radius>0.075"
        b"</radius></cylinder></geometry></collision></link></model></sdf>"
    )
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w") as archive:
        member = tarfile.TarInfo("worlds/world_0.world")
        member.size = len(world)
        archive.addfile(member, io.BytesIO(world))
    return stream.getvalue()


def seeds(folder):
    """Good files by name, with what reads them and how their bytes are packed."""
    grid = OccupancyGrid.from_text("....\n.#?.\n....")
    for suffix in (".yaml", ".map", ".npy"):
        plain = grid if suffix == ".yaml" else OccupancyGrid.from_text("....\n.#..\n....")
        save_map(plain, folder / f"saved{suffix}")
    save_episode(episode(), folder / "e.npz")
    np.save(folder / "path_1.npy", np.arange(10).reshape(5, 2))
    drawn = b"[map]\nrows = ['....', '....', '..#.']\nresolution = 1.0\norigin = [0.0, 0.0]\n"
    goals = (
        b"[[goals]]\nx = 2.5\ny = 2.5\nheading = 1.0\n[sensor]\nbeams = 90\nrange_bound = 0.01\n"
    )
    things = (
        b"[[obstacles]]\nbox = [3.5, 1.5, 0.2, 0.2]\nyaw = 0.3\n[[movers]]\nradius = 0.2\n"
        b"waypoints = [[0.5, 2.5], [3.5, 2.5]]\nspeed = 0.5\n[[movers]]\nradius = 0.2\n"
        b"track = [[0.0, 1.0, 2.0], [1.0, 2.0, 2.0]]\n[navigator]\nperiod = 0.05\n"
        b"[navigator.dwa]\nhorizon = 2.0\n"
    )
    head = b'robot = "pioneer3dx"\nstart = [0.9, 0.9, 0.0]\nseed = 3\ntime_limit = 20.0\n'
    dynabarn = {"obstacle_radius": 0.5, "start": [0, 0, 0], "goal": [5, 0]}
    dynabarn["walls"] = [{"center": [0, 1], "size": [2, 0.1]}]
    keys = [[0.0, 1.0, 1.0], [2.0, 1.0, 2.0]]
    row = {"world": 0, "difficulty": "easy", "obstacles": [{"keys": keys, "length": 2.0}]}
    test = {"scenario": "office", "test": 1, "prior_map": "map.yaml", "true_map": None}
    test |= {"start": [0, 0, 0], "goal": [1, 1, 0]}
    rows = [{"number": 0, "repeat": 0, "outcome": "arrived", "time": 1.0, "length": 2.0}]
    result = {"suite": "barn", "options": {}, "rows": rows}
    image = (folder / "saved.pgm").read_bytes()
    yield "h.yaml", header_of("saved.pgm"), load_map, None
    yield "image.pgm", image, load_map, "pgm.yaml"
    yield "plain.pgm", b"P2 # grey\n3 2\n255\n0 255 205\n1 2 3\n", load_map, "plain.yaml"
    yield "image.png", png(4, 3, 0), load_map, "png.yaml"
    yield "colour.png", png(4, 3), load_map, "colour.yaml"
    yield "drawn.txt", b"....\n.#?.\n....\n", load_map, None
    for name in ("saved.map", "saved.npy"):
        yield f"m{name}", (folder / name).read_bytes(), load_map, None
    yield "s.toml", head + drawn + goals + things, load_scenario, None
    yield "s.scen", b"version 1\n0\ta.map\t9\t9\t1\t1\t2\t2\t1.41421356\n", load_scenarios, None
    yield "e.npz", (folder / "e.npz").read_bytes(), load_episode, None
    yield "r.json", json.dumps(result).encode(), load_result, None
    yield (
        "p.csv",
        b"t_s,ped_id,x_m,y_m\n0.0,1,2.0,3.0\n0.4,1,2.5,3.0\n",
        load_recording.__wrapped__,
        None,
    )
    dynabarn["worlds"] = [row]
    yield "dynabarn.json", json.dumps(dynabarn).encode(), load_dynabarn.__wrapped__, "."
    yield "scenarios.json", json.dumps([test]).encode(), load_mrpb.__wrapped__, "."
    yield "worlds.tar.xz", barn_archive(), load_barn_worlds.__wrapped__, "."
    yield "path_files/path_0.npy", (folder / "path_1.npy").read_bytes(), official, "."


def official(folder):
    return official_length(folder, 0)


MAPS = ["h.yaml", "image.pgm", "plain.pgm", "image.png", "colour.png", "drawn.txt"]
MAPS += ["msaved.map", "msaved.npy"]
DATA = ["p.csv", "dynabarn.json", "scenarios.json", "worlds.tar.xz", "path_files/path_0.npy"]
OTHERS = ["s.toml", "s.scen", "e.npz", "r.json"]


@pytest.mark.filterwarnings("ignore::dynastar.errors.DynastarWarning")
@pytest.mark.parametrize("name", [*MAPS, *DATA, *OTHERS])
def test_of_any_damage_only_errors_of_input_come_out(name, tmp_path):
    (tmp_path / "path_files").mkdir()
    [(data, load, asked)] = [rest for known, *rest in seeds(tmp_path) if known == name]
    file = tmp_path / name
    asked = tmp_path / (asked or name)
    if asked.suffix == ".yaml" and asked != file:
        asked.write_bytes(header_of(name))
    packed = lzma.compress if name.endswith(".xz") else bytes
    file.write_bytes(packed(data))
    load(asked)
    rng = np.random.default_rng(zlib.crc32(name.encode()))
    told = []
    for number in range(200):
        damaged = mutated(data, rng)
        file.write_bytes(packed(damaged) if number % 4 else mutated(packed(data), rng))
        try:
            load(asked)
        except InputError as error:
            told.append(str(error))
    assert len(told) > 20
    assert max(map(len, told)) < 500
    assert not any("\n" in words for words in told)
