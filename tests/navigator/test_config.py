import pytest

from dynastar.navigator.config import CELLS, NavigatorConfig, fitted


@pytest.mark.parametrize(
    ("inscribed", "share"), [(0.3, 1.0), (0.2, 1.0), (0.15, 0.75), (0.105, 0.525), (0.01, 0.5)]
)
def test_small_robots_get_smaller_cells_and_as_many(inscribed, share):
    config = NavigatorConfig()
    got = fitted(config, inscribed)
    assert got.local_map.resolution == pytest.approx(share * config.local_map.resolution)
    assert got.local_map.size / got.local_map.resolution == pytest.approx(
        config.local_map.size / config.local_map.resolution
    )
    assert got.planning_resolution <= max(inscribed / CELLS, 0.5 * config.local_map.resolution)
    assert fitted(got, inscribed).local_map.resolution <= got.local_map.resolution


def test_nothing_but_the_cells_is_changed():
    config = NavigatorConfig(latency=0.1)
    cells = config.local_map, config.planning_resolution
    got = fitted(config, 0.1)._replace(local_map=cells[0], planning_resolution=cells[1])
    assert got == config
