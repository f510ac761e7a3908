import pytest

from dynastar.navigator.config import CELLS, NavigatorConfig, fitted
from dynastar.perception import LocalMapConfig
from dynastar.robot import Robot


def a_robot(radius):
    return Robot.simple(radius, 0.5)


@pytest.mark.parametrize(
    ("half_width", "share"), [(0.3, 1.0), (0.2, 1.0), (0.15, 0.75), (0.105, 0.525), (0.01, 0.5)]
)
def test_small_robots_get_smaller_cells_and_as_many(half_width, share):
    config = NavigatorConfig()
    got = fitted(config, a_robot(half_width))
    assert got.resolution == pytest.approx(share * config.resolution)
    assert got.resolution <= max(half_width / CELLS, 0.5 * config.resolution)
    cells = config.local_map.size / config.resolution
    assert got.local_map.size / got.resolution == pytest.approx(cells)
    assert fitted(got, a_robot(half_width)).resolution <= got.resolution


def test_nothing_but_the_cells_is_changed():
    config = NavigatorConfig(latency=0.1)
    cells = {"local_map": config.local_map, "resolution": config.resolution}
    got = fitted(config, a_robot(0.1))._replace(**cells)
    assert got == config


@pytest.mark.parametrize("size", [2.0, 3.0, 3.9])
def test_a_small_robots_local_map_may_be_as_small_as_any(size):
    config = NavigatorConfig(local_map=LocalMapConfig(size=size))
    assert fitted(config, a_robot(0.105)).local_map.size == pytest.approx(max(2.0, 0.525 * size))
