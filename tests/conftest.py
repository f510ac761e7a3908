"""What all tests share: where the public data sets lie."""

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def pytest_sessionstart(session: pytest.Session) -> None:
    """Compiles the kernels once, side by side, and not in each of the test processes."""
    if not hasattr(session.config, "workerinput"):
        from dynastar.cli.compiling import prepare

        prepare()


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """The public data sets: $DYNASTAR_DATA, else ../shared/data beside the clone, else skip."""
    named = os.environ.get("DYNASTAR_DATA")
    folder = Path(named) if named else ROOT.parent / "shared" / "data"
    if named and not folder.is_dir():
        pytest.fail(f"DYNASTAR_DATA is {named}, which is no folder")
    if not folder.is_dir():
        pytest.skip(
            f"the public data sets are not in {folder}: set DYNASTAR_DATA to have them read"
        )
    return folder.resolve()
