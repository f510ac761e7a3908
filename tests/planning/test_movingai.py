import csv

import numpy as np
import pytest

from dynastar.planning import SearchGrid


def occupied_of(path):
    """The mask of a .map file, first line first."""
    lines = path.read_text().splitlines()
    height = int(lines[1].split()[1])
    return np.array([[mark not in ".GS" for mark in line] for line in lines[4 : 4 + height]])


@pytest.mark.data
def test_every_verified_optimum_is_found(data_dir):
    folder = data_dir / "movingai"
    with (folder / "verified_scenarios.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["match"] == "1"]
    assert len(rows) > 300
    grids = {}
    for row in rows:
        path = folder / row["set"] / row["map"]
        if path not in grids:
            grids[path] = SearchGrid(occupied_of(path))
        start, goal = (int(row["sy"]), int(row["sx"])), (int(row["gy"]), int(row["gx"]))
        found = grids[path].search(start, goal)
        assert found.cost == pytest.approx(float(row["file_length"]), abs=0.005)
        assert found.cost == pytest.approx(float(row["recomputed_length"]), rel=1e-6)
        assert grids[path].search(start, goal, "improved").cost >= found.cost - 1e-6
