"""Where the data of a suite are found."""

from pathlib import Path

import pytest

from dynastar.bench.missions import Options, data_folder
from dynastar.errors import DataError


def test_the_data_are_in_the_folder_or_one_below(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("DYNASTAR_DATA", raising=False)
    (tmp_path / "set").mkdir()
    (tmp_path / "set" / "index.csv").touch()
    for named in (tmp_path, tmp_path / "set"):
        assert data_folder(Options(data=named), "set", "index.csv") == tmp_path / "set"
    with pytest.raises(DataError, match="--data"):
        data_folder(Options(), "set", "index.csv")
    with pytest.raises(DataError, match=r"index\.csv"):
        data_folder(Options(data=tmp_path / "nowhere"), "set", "index.csv")
    monkeypatch.setenv("DYNASTAR_DATA", str(tmp_path))
    assert data_folder(Options(), "set", "index.csv") == tmp_path / "set"
