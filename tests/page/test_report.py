"""The page that replays episodes: whole in itself, of bounded size, with the episode's numbers in it."""

import base64
import gzip
import json
import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dynastar import io
from dynastar.cli import main
from dynastar.dwa.dwa import TERMS
from dynastar.errors import EpisodeError, InputError
from dynastar.page import report_html
from dynastar.page.packing import packed, runs, static

EXAMPLES = Path(__file__).parents[2] / "examples"
KINDS = {"int8": "i1", "uint8": "u1", "uint16": "<u2", "int32": "<i4", "float32": "<f4"}


@pytest.fixture(scope="module")
def episode():
    scenario = replace(io.load_scenario(EXAMPLES / "features" / "movers.toml"), time_limit=8.0)
    return io.run(scenario, trace=True)


def data_of(page):
    packed = re.search(r'<script id="data"[^>]*>([^<]*)</script>', page)[1]
    return json.loads(gzip.decompress(base64.b64decode(packed)))


def unpacked(array):
    return np.frombuffer(base64.b64decode(array["data"]), KINDS[array["kind"]])


def test_the_page_has_the_episode_in_it(episode):
    [data] = data_of(report_html([episode]))
    assert unpacked(data["grid"]["values"]).tolist() == episode.grid.values.reshape(-1).tolist()
    np.testing.assert_allclose(
        unpacked(data["poses"]).reshape(-1, 3), episode.trajectory.poses, rtol=1e-4, atol=1e-6
    )
    trace = data["trace"]
    rows = unpacked(trace["candidateRows"])
    assert len(rows) == len(episode.commands)
    assert rows.sum() == len(unpacked(trace["refused"]))
    assert [plan["reason"] for plan in data["plans"]] == [plan.reason for plan in episode.plans]
    table, places = data["states"]["table"], unpacked(data["states"]["rows"])
    assert [table[place] for place in places] == list(episode.states)


def test_the_page_needs_no_network_and_is_small(episode):
    page = report_html([episode, episode])
    assert not re.search(r"(src|href)\s*=|https?://|@import|fetch\(", page)
    assert len(page) < 1_000_000
    assert len(data_of(page)) == 2


def test_names_cannot_break_the_page(episode):
    named = replace(episode, scenario={"name": "</title><script>alert(1)</script>{{data}}"})
    page = report_html([named])
    assert "<script>alert" not in page
    assert data_of(page)[0]["name"] == named.scenario["name"]


def test_an_episode_without_a_trace_is_shown_too(episode):
    [data] = data_of(report_html([replace(episode, trace=None)]))
    assert data["trace"] is None
    with pytest.raises(InputError, match="one or two"):
        report_html([])


def test_a_notebook_shows_the_replay(episode):
    html = episode._repr_html_()
    assert html.startswith("<iframe srcdoc=")
    assert html.count("<") == 2


@pytest.mark.parametrize("far", [0.0, 5000.0, 600_000.0, -600_000.0])
def test_places_are_exact_wherever_the_map_lies(far):
    places = np.array([[far + 123.4, far - 0.37], [math.nan, math.inf]])
    data = base64.b64decode(packed(places, np.float32)["data"])
    found = np.frombuffer(data, "<f4").reshape(2, 2)
    finest = max(0.003, float(np.spacing(np.float32(abs(far)))))
    np.testing.assert_allclose(found, places, atol=finest, rtol=0.0)


def test_explored_cells_are_written_as_runs():
    cells = np.array([(2, 3), (0, 1), (2, 4), (2, 6), (0, 2)], np.int32)
    assert runs(cells).tolist() == [[0, 1, 2], [2, 3, 2], [2, 6, 1]]
    assert runs(cells[:0]).shape == (0, 3)


def test_a_trace_is_saved_and_loaded(episode, tmp_path):
    io.save_episode(episode, tmp_path / "episode.npz")
    loaded = io.load_episode(tmp_path / "episode.npz").trace
    for name, value in vars(episode.trace).items():
        assert np.array_equal(getattr(loaded, name), value, equal_nan=name in ("terms", "chosen"))


def test_an_episode_of_when_eq_9_had_fewer_terms_is_shown(episode, tmp_path):
    older = replace(episode, trace=replace(episode.trace, terms=episode.trace.terms[:, :5]))
    io.save_episode(older, tmp_path / "older.npz")
    [data] = data_of(report_html([io.load_episode(tmp_path / "older.npz")]))
    assert data["termNames"] == ["heading", "dist", "vel", "simi", "risk"]


def test_an_episode_with_more_terms_than_are_known_is_refused(episode):
    terms = np.zeros((len(episode.commands), 7), np.float32)
    newer = replace(episode, trace=replace(episode.trace, terms=terms))
    with pytest.raises(EpisodeError, match=r"has 7 terms of Eq\. 9, this dynastar knows 6"):
        report_html([newer])


def test_every_term_has_a_colour_of_its_own():
    [shades] = re.findall(r"TERM_SHADES = \[(.*)\];", static("panel.js"))
    assert len(set(shades.split(", "))) == len(shades.split(", ")) == len(TERMS)


def test_a_trace_changes_nothing(episode):
    scenario = replace(io.load_scenario(EXAMPLES / "features" / "movers.toml"), time_limit=8.0)
    assert np.array_equal(io.run(scenario).commands, episode.commands)


def test_the_command(episode, tmp_path, capsys):
    io.save_episode(episode, tmp_path / "episode.npz")
    assert main(["view", str(tmp_path)]) == 0
    assert capsys.readouterr().out.strip() == str(tmp_path / "report.html")
    named = str(tmp_path / "episode.npz")
    assert main(["view", named, named, "--out", str(tmp_path / "both.html")]) == 0
    assert main(["view", named, named, named]) == 2
    (tmp_path / "empty").mkdir()
    assert main(["view", str(tmp_path / "empty")]) == 2
    assert capsys.readouterr().err.count("\n") == 2
