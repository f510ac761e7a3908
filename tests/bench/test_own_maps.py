from dynastar.bench.own_maps import drawn, own_forty, own_twenty
from dynastar.bench.paper import own_world
from dynastar.planning import SearchGrid


def test_the_own_maps_have_a_way_from_corner_to_corner():
    big, small = own_forty(), own_twenty()
    assert big.occupied.shape == (40, 40)
    assert small.shape == (20, 20)
    assert len(SearchGrid(big.occupied).search(big.start, big.goal, "auto").cells) >= 40
    assert len(SearchGrid(small).search((0, 0), (19, 19), "auto").cells) >= 20


def test_the_last_line_of_a_picture_is_row_0():
    assert drawn("..#\n#..").tolist() == [[True, False, False], [False, False, True]]


def test_the_own_world_is_furnished_by_the_suites_rule():
    made = own_world()
    assert (made.grid.frame.x, made.grid.frame.y, made.grid.resolution) == (1.0, 1.0, 1.0)
    assert (len(made.obstacles), len(made.movers), made.start[:2]) == (2, 1, (1.5, 1.5))


def test_the_own_worlds_unknown_blocks_stand_on_the_improved_path():
    way = SearchGrid(own_twenty()).search((0, 0), (19, 19), "improved").cells
    for ring in own_world().obstacles:
        x, y = ring.mean(axis=0)
        assert [int(y - 1.0), int(x - 1.0)] in way.tolist()
