import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.errors import ConfigError, GoalOccupied, MapError, NoPath, OutOfMap, StartOccupied
from dynastar.planning import PLANNERS, HeuristicConfig, SearchGrid
from dynastar.planning.heuristic import kernel_terms
from dynastar.planning.labels import MAX_STAMP
from naive import improved, shortest

CONFIGS = [
    HeuristicConfig(),
    HeuristicConfig(estimate="euclidean"),
    HeuristicConfig(exponential=False),
    HeuristicConfig(parent=False),
    HeuristicConfig(k=0.0),
    HeuristicConfig(k=20.0),
    HeuristicConfig(beta="interior"),
    HeuristicConfig(q="line"),
    HeuristicConfig(q="ratio"),
    HeuristicConfig(weight=1.5),
]


def random_world(seed, size=14, density=0.3):
    """A random mask and two free cells."""
    rng = np.random.default_rng(seed)
    occupied = rng.random(rng.integers(2, size, 2)) < density
    occupied[0, 0] = occupied[-1, -1] = False
    free = np.argwhere(~occupied)
    start, goal = free[rng.integers(0, len(free), 2)]
    return occupied, tuple(map(int, start)), tuple(map(int, goal))


def assert_legal(occupied, cells, start, goal):
    """Free cells, single steps, no corner cut."""
    assert tuple(cells[0]) == start
    assert tuple(cells[-1]) == goal
    assert not occupied[cells[:, 0], cells[:, 1]].any()
    steps = np.diff(cells, axis=0)
    assert (np.abs(steps).max(axis=1, initial=0) == 1).all() if len(steps) else True
    for (r, c), (dr, dc) in zip(cells[:-1], steps, strict=True):
        assert not occupied[r + dr, c]
        assert not occupied[r, c + dc]


def structured_world(seed):
    """A mask of blocks wide and long enough to span words of bits, and two free cells."""
    rng = np.random.default_rng(seed)
    coarse = rng.random(rng.integers(1, 24, 2)) < rng.choice([0.1, 0.3, 0.5])
    block = rng.integers(1, 12, 2)
    occupied = np.kron(coarse, np.ones(block, bool))[: rng.integers(2, 200), : rng.integers(2, 200)]
    occupied[0, 0] = occupied[-1, -1] = False
    free = np.argwhere(~occupied)
    start, goal = free[rng.integers(0, len(free), 2)]
    return occupied, tuple(map(int, start)), tuple(map(int, goal))


@pytest.mark.parametrize("algorithm", ["dijkstra", "astar", "jump", "auto"])
@pytest.mark.parametrize("world", [random_world, structured_world])
@given(seed=st.integers(0, 10**9))
@settings(max_examples=75, deadline=None)
def test_the_shortest_way_is_found(algorithm, world, seed):
    occupied, start, goal = world(seed)
    lengths = shortest(occupied, start)
    grid = SearchGrid(occupied)
    if goal not in lengths:
        with pytest.raises(NoPath):
            grid.search(start, goal, algorithm)
        return
    found = grid.search(start, goal, algorithm)
    assert found.cost == pytest.approx(lengths[goal], rel=1e-6)
    assert_legal(occupied, found.cells, start, goal)
    euclidean = grid.search(start, goal, algorithm, HeuristicConfig(estimate="euclidean"))
    assert euclidean.cost == pytest.approx(lengths[goal], rel=1e-6)


def test_an_exact_search_closes_what_it_must_and_no_more():
    for seed in range(40):
        occupied, start, goal = random_world(seed, size=30)
        lengths = shortest(occupied, start)
        if goal not in lengths:
            continue
        rest = shortest(occupied, goal)
        found = SearchGrid(occupied).search(start, goal, "astar", explored=True)
        closed = {tuple(map(int, cell)) for cell in found.explored}
        for (r, c), g in lengths.items():
            rows, columns = abs(r - goal[0]), abs(c - goal[1])
            f = g + max(rows, columns) + (math.sqrt(2.0) - 1.0) * min(rows, columns)
            assert ((r, c) in closed) if f < lengths[goal] - 1e-3 else True
            assert ((r, c) not in closed) if f > lengths[goal] + 1e-3 else True
        assert len(closed) == found.expanded
        assert rest[start] == pytest.approx(found.cost)


def test_jumping_expands_few_cells_of_an_open_map():
    grid = SearchGrid(np.zeros((300, 500), bool))
    found = grid.search((10, 3), (290, 490), "jump")
    assert found.cost == pytest.approx(487 - 280 + 280 * math.sqrt(2.0))
    assert found.expanded < 5


def test_auto_jumps_on_open_maps_and_not_on_random_ones():
    rng = np.random.default_rng(0)
    rooms = np.zeros((200, 200), bool)
    rooms[::40] = rooms[:, ::40] = True
    rooms[20::40, ::40] = rooms[::40, 20::40] = False
    noise = rng.random((200, 200)) < 0.3
    noise[1, 1] = noise[2, 2] = False
    for occupied, kernel in ((rooms, "jump"), (noise, "astar")):
        grid = SearchGrid(occupied)
        auto = grid.search((1, 1), (2, 2), "auto", explored=True)
        same = grid.search((1, 1), (2, 2), kernel, explored=True)
        assert auto.expanded == same.expanded
        assert (auto.explored == same.explored).all()
        assert grid._prefers_jumps() == (kernel == "jump")


@pytest.mark.parametrize("algorithm", ["weighted", "improved"])
@pytest.mark.parametrize("config", CONFIGS)
def test_every_reading_of_eqs_2_and_3_is_what_it_says(algorithm, config):
    for seed in range(25):
        occupied, start, goal = random_world(seed, size=18)
        expected = improved(occupied, start, goal, PLANNERS[algorithm](config))
        if expected is None:
            continue
        length, closed = expected
        found = SearchGrid(occupied).search(start, goal, algorithm, config, explored=True)
        assert found.cost == pytest.approx(length, rel=1e-12)
        assert found.expanded == len(closed)
        assert {tuple(cell) for cell in found.explored} == closed
        assert_legal(occupied, found.cells, start, goal)


@pytest.mark.parametrize("config", CONFIGS)
@pytest.mark.parametrize("fine", [2, 3])
def test_eq_2_counts_cells_of_the_map_however_it_is_refined_and_inflated(config, fine):
    """P, Q and k are what they were on the map itself, in its cells."""
    for seed in range(10):
        occupied, start, goal = random_world(seed, size=18)
        refined = np.kron(occupied, np.ones((fine, fine), np.uint8))
        grid = SearchGrid(refined, refined, fine)
        a, b = ((fine * row, fine * column) for row, column in (start, goal))
        coarse = kernel_terms(config, start, goal, int(occupied.sum()))
        found = kernel_terms(config, a, b, int(grid.sums[-1, -1]), fine)
        assert found.k == fine * coarse.k  # in steps of the finer grid, as h(n) is
        counts = int(grid.sums[-1, -1]) / found.q, occupied.sum() / coarse.q
        corner = ((abs(a[0] - b[0]) + 1) * (abs(a[1] - b[1]) + 1)) / (
            fine**2 * (abs(start[0] - goal[0]) + 1) * (abs(start[1] - goal[1]) + 1)
        )
        line = (max(abs(a[0] - b[0]), abs(a[1] - b[1])) + 1) / (
            fine * (max(abs(start[0] - goal[0]), abs(start[1] - goal[1])) + 1)
        )
        share = {"rectangle": corner, "line": line, "ratio": 1.0}[config.q]
        assert counts[0] * share == pytest.approx(counts[1])


@given(st.integers(0, 10**9))
@settings(max_examples=50, deadline=None)
def test_what_eq_2_counts_may_be_another_mask_than_what_is_searched(seed):
    occupied, _, _ = random_world(seed, size=30, density=0.25)
    inside = np.zeros_like(occupied)
    inside[::2] = occupied[::2]  # any other mask
    mask = inside.view(np.uint8).copy()
    grid = SearchGrid(occupied, mask)
    assert (grid.sums[1:, 1:] == inside.cumsum(0).cumsum(1)).all()
    rng = np.random.default_rng(seed)
    row, column = (int(rng.integers(0, n)) for n in occupied.shape)
    patch = rng.random(mask[row : row + 5, column : column + 7].shape) < 0.5
    mask[row : row + 5, column : column + 7] = patch
    grid.recount()
    assert (grid.sums[1:, 1:] == mask.astype(int).cumsum(0).cumsum(1)).all()
    grid.update(row, column, ~occupied[row : row + 3, column : column + 3])
    assert (grid.sums[1:, 1:] == mask.astype(int).cumsum(0).cumsum(1)).all()


def test_a_grid_is_searched_again_and_again():
    occupied, _, _ = random_world(5, size=40, density=0.2)
    grid = SearchGrid(occupied)
    free = np.argwhere(~occupied)
    rng = np.random.default_rng(1)
    lengths = {}
    for i, j in rng.integers(0, len(free), (100, 2)):
        start, goal = tuple(map(int, free[i])), tuple(map(int, free[j]))
        lengths = shortest(occupied, start)
        if goal in lengths:
            assert grid.search(start, goal).cost == pytest.approx(lengths[goal])


def test_the_stamp_runs_over():
    grid = SearchGrid(np.zeros((3, 3), dtype=bool))
    grid._stamp = MAX_STAMP - 2
    for _ in range(5):
        assert grid.search((0, 0), (2, 2)).cost == pytest.approx(math.sqrt(8))


@given(st.integers(0, 10**9))
@settings(max_examples=50, deadline=None)
def test_an_updated_grid_is_as_if_made_anew(seed):
    occupied, start, goal = random_world(seed, size=80)
    grid = SearchGrid(occupied)
    assert grid.lines
    assert grid.sums[-1, -1] == occupied.sum()
    rng = np.random.default_rng(seed)
    rows, columns = occupied.shape
    row, column = rng.integers(0, rows), rng.integers(0, columns)
    patch = rng.random((rng.integers(0, rows - row + 1), rng.integers(0, columns - column + 1)))
    changed = occupied.copy()
    changed[row : row + patch.shape[0], column : column + patch.shape[1]] = patch < 0.3
    grid.update(row, column, patch < 0.3)
    anew = SearchGrid(changed)
    assert (grid.occupied == changed).all()
    assert (grid.near == anew.near).all()
    assert (grid.lines[0] == anew.lines[0]).all()
    assert (grid.lines[1] == anew.lines[1]).all()
    assert (grid.sums == anew.sums).all()
    assert (grid.sums[1:, 1:] == changed.cumsum(0).cumsum(1)).all()
    if not changed[start] and not changed[goal]:
        try:
            expected = anew.search(start, goal, "improved")
        except NoPath:
            with pytest.raises(NoPath):
                grid.search(start, goal, "improved")
        else:
            assert (grid.search(start, goal, "improved").cells == expected.cells).all()


@given(
    st.integers(0, 10**9),
    st.lists(st.sampled_from(["close", "close", "open", "flood", "move"]), max_size=8),
)
@settings(max_examples=200, deadline=None)
def test_auto_finds_the_shortest_way_again_whatever_changed(seed, changes):
    occupied, start, goal = random_world(seed, size=20, density=0.2)
    rng = np.random.default_rng(seed)
    grid = SearchGrid(occupied)
    for change in ["none", *changes]:
        if change in ("close", "open"):
            row, column = (int(rng.integers(0, n)) for n in occupied.shape)
            patch = occupied[row : row + 4, column : column + 4]
            patch[rng.random(patch.shape) < 0.5] = change == "close"
            occupied[start] = occupied[goal] = False
            grid.update(row, column, patch)
        elif change == "move":
            free = np.argwhere(~occupied)
            start = tuple(map(int, free[rng.integers(0, len(free))]))
        elif change == "flood":
            grid.flood(start)
        grid._jumps = False
        lengths = shortest(occupied, start)
        if goal not in lengths:
            with pytest.raises(NoPath):
                grid.search(start, goal, "auto")
            continue
        found = grid.search(start, goal, "auto", explored=True)
        assert found.cost == pytest.approx(lengths[goal], rel=1e-6)
        assert_legal(occupied, found.cells, start, goal)
        assert len(found.explored) == found.expanded
        with pytest.raises(NoPath, match="flood"):
            grid.way_to(start)


def test_auto_does_not_search_again_from_the_start_where_the_goal_is_closed_in():
    occupied = np.random.default_rng(0).random((100, 100)) < 0.3
    occupied[48:53, 48:53] = True
    occupied[50, 50] = occupied[0, 0] = False
    grid = SearchGrid(occupied)
    with pytest.raises(NoPath, match="1 cells were expanded"):
        grid.search((0, 0), (50, 50), "auto")
    assert grid.expanded_cells().tolist() == [[50, 50]]


def test_what_closes_near_the_start_costs_little_to_go_round():
    occupied = np.random.default_rng(0).random((300, 300)) < 0.2
    occupied[:20, :20] = occupied[-20:, -20:] = False
    grid = SearchGrid(occupied)
    first = grid.search((5, 5), (295, 295), "auto")
    row, column = map(int, first.cells[30])
    patch = np.ones((8, 8), bool)
    occupied[row : row + 8, column : column + 8] = True
    grid.update(row, column, patch)
    again = grid.search((5, 5), (295, 295), "auto")
    assert again.expanded < 0.25 * first.expanded
    assert again.cost == pytest.approx(SearchGrid(occupied).search((5, 5), (295, 295)).cost)
    assert again.cost >= first.cost


def test_a_flood_reaches_what_dijkstra_reaches():
    occupied, start, _ = random_world(11, size=30)
    grid = SearchGrid(occupied)
    with pytest.raises(NoPath):
        grid.way_to(start)
    lengths = grid.flood(start)
    expected = shortest(occupied, start)
    assert np.isfinite(lengths).sum() == len(expected)
    for cell, length in expected.items():
        assert lengths[cell] == pytest.approx(length, rel=1e-6)
        assert_legal(occupied, grid.way_to(cell), start, cell)
    with pytest.raises(NoPath):
        grid.way_to(tuple(map(int, np.argwhere(occupied)[0])))


def test_the_improved_one_expands_less_than_the_traditional_one():
    rng = np.random.default_rng(0)
    occupied = rng.random((100, 100)) < 0.2
    occupied[0, 0] = occupied[99, 99] = False
    grid = SearchGrid(occupied)
    counts = {name: grid.search((0, 0), (99, 99), name).expanded for name in PLANNERS}
    assert counts["improved"] < 0.5 * counts["astar"] < 0.5 * counts["dijkstra"]


def test_errors_have_names_and_say_where():
    grid = SearchGrid([[False, True, False], [False, True, False]])
    with pytest.raises(OutOfMap, match=r"goal, cell \(0, 3\), is off the map"):
        grid.search((0, 0), (0, 3))
    with pytest.raises(OutOfMap, match="start"):
        grid.search((-1, 0), (0, 0))
    with pytest.raises(StartOccupied, match=r"\(0, 1\)"):
        grid.search((0, 1), (0, 0))
    with pytest.raises(GoalOccupied, match=r"\(0, 1\)"):
        grid.search((0, 0), (0, 1))
    with pytest.raises(NoPath, match="no way leads"):
        grid.search((0, 0), (0, 2))
    with pytest.raises(ConfigError, match="did you mean 'astar'"):
        grid.search((0, 0), (0, 0), "a-star")
    with pytest.raises(MapError, match="expected"):
        SearchGrid(np.zeros((0, 3), dtype=bool))
    with pytest.raises(OutOfMap, match="leaves the map"):
        grid.update(1, 2, np.zeros((2, 1), dtype=bool))
    with pytest.raises(MapError, match=r"row 1\.5, column 0: expected whole numbers"):
        grid.update(1.5, 0, np.zeros((1, 1), dtype=bool))


def test_start_is_goal():
    found = SearchGrid(np.zeros((2, 2), dtype=bool)).search((1, 1), (1, 1), "improved")
    assert found.cells.tolist() == [[1, 1]]
    assert found.cost == 0.0
    assert found.expanded == 1
