"""Table I as it is read."""

from dynastar.bench import table1, table1_tables


def rows():
    own = table1.own_row()
    for kind, factor in (("random", 1.0), ("random", 2.0), ("random", 3.0), ("maze", 4.0)):
        expanded = factor * own["traditional"]["expanded"]
        yield {**own, "kind": kind, "improved": {**own["improved"], "expanded": expanded}}


def test_medians_are_by_kind_with_their_intervals_and_the_pool_comes_after():
    made = list(rows())
    _, kinds, cells, *_ = table1_tables.tables(made, made[0])
    assert (kinds.name, cells.name) == ("table1-kinds", "table1-cells")
    heading, expanded, *_ = kinds.cells
    assert heading[1:] == ["random", "maze", "all", "all: p95", "all: worst", "paper"]
    assert expanded[1:4] == ["2.000 (1.000 to 3.000)", "4.000", "2.500 (1.000 to 4.000)"]
    improved = next(line for line in cells.cells if line[0] == "improved A*, grid path")
    assert improved[1:4] == ["1.750", "2.500", "3.250"]
    assert improved[-1] == "1.000 to 4.000"
