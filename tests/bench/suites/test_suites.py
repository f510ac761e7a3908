"""The suites by name."""

import pytest

from dynastar.bench.suites import SUITES, load_suite
from dynastar.errors import ConfigError


def test_suites_are_found_by_name() -> None:
    assert set(SUITES) >= {"movingai", "paper"}
    with pytest.raises(ConfigError, match="'movingai'"):
        load_suite("movingia")
