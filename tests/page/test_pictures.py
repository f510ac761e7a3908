"""``make pictures``: the page to drive in is waited for and photographed in spite of its policy."""

import sys
from pathlib import Path

import pytest

pytest.importorskip("starlette")
pytest.importorskip("uvicorn")
pytest.importorskip("playwright")

sys.path.insert(0, str(Path(__file__).parents[2] / "docs"))
import make_pictures


def test_the_playgrounds_picture_is_taken(chromium, tmp_path, monkeypatch):
    monkeypatch.setattr(make_pictures, "MEDIA", tmp_path)
    monkeypatch.setattr(make_pictures, "PLAY_AT", 0.2)
    page = make_pictures.opened(chromium)
    make_pictures.playground(page)
    page.close()
    assert (tmp_path / "play.png").stat().st_size > 10_000
