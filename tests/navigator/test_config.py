import pytest

from dynastar.navigator.config import CELLS, NavigatorConfig, fitted


@pytest.mark.parametrize(
    ("inscribed", "share"), [(0.3, 1.0), (0.2, 1.0), (0.15, 0.75), (0.105, 0.525), (0.01, 0.5)]
)
def test_small_robots_get_smaller_cells_and_as_many(inscribed, share):
    config = NavigatorConfig()
    got = fitted(config, inscribed)
    assert got.resolution == pytest.approx(share * config.resolution)
    assert got.resolution <= max(inscribed / CELLS, 0.5 * config.resolution)
    cells = config.local_map.size / config.resolution
    assert got.local_map.size / got.resolution == pytest.approx(cells)
    assert fitted(got, inscribed).resolution <= got.resolution


def test_nothing_but_the_cells_is_changed():
    config = NavigatorConfig(latency=0.1)
    cells = {"local_map": config.local_map, "resolution": config.resolution}
    got = fitted(config, 0.1)._replace(**cells)
    assert got == config
