"""Missions on a Dask cluster: a scheduler and two workers on the loopback."""

import os
import re
import subprocess
import sys
import threading
import time
from collections.abc import Iterator

import pytest

from dynastar.bench.workers import completed
from dynastar.cli import main
from dynastar.errors import InputError

pytest.importorskip("distributed", reason="needs the extra: pip install '.[dask]'")

pytestmark = pytest.mark.filterwarnings("ignore")  # of distributed, as it closes


def launch(*words: str) -> "subprocess.Popen[str]":
    command = [sys.executable, "-m", "distributed.cli.dask_" + words[0], *words[1:]]
    environment = os.environ | {"OMP_NUM_THREADS": "1", "DASK_DISTRIBUTED__DASHBOARD__LINK": ""}
    return subprocess.Popen(
        command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True, env=environment
    )


def said(process: "subprocess.Popen[str]", pattern: str) -> str:
    assert process.stderr is not None
    for line in process.stderr:
        found = re.search(pattern, line)
        if found:
            return found[0]
    raise AssertionError(f"the process ended without {pattern}")


@pytest.fixture
def cluster() -> Iterator[tuple[str, list["subprocess.Popen[str]"]]]:
    """The scheduler's address and two workers' processes."""
    options = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
    processes = [launch("scheduler", *options)]
    try:
        address = said(processes[0], r"tcp://127\.0\.0\.1:\d+")
        options = ["--nthreads", "1", "--no-nanny", "--no-dashboard", "--memory-limit", "0"]
        processes += [launch("worker", address, *options) for _ in range(2)]
        for worker in processes[1:]:
            said(worker, "Registered to")
        yield address, processes[1:]
    finally:
        for process in processes:
            process.kill()
            process.communicate()


def test_no_job_is_lost_or_counted_twice_when_a_worker_is_killed(cluster, tmp_path):
    """Jobs from the tenth on wait until the worker has been killed in the middle of one of them."""
    address, workers = cluster
    killed = tmp_path / "killed"

    def work(job):  # defined here, so that it is sent and not imported
        import os
        import time

        if job >= 10:
            (tmp_path / str(os.getpid())).touch()
            while not killed.exists():
                time.sleep(0.01)
        return {"job": job, "worker": os.getpid()}

    def kill():
        while not (tmp_path / str(workers[0].pid)).exists():
            time.sleep(0.01)
        workers[0].kill()
        workers[0].wait()
        killed.touch()

    killer = threading.Thread(target=kill)
    killer.start()
    rows = list(completed(work, range(30), address))
    killer.join()
    assert sorted(index for index, _ in rows) == list(range(30))
    assert all(row["job"] == index for index, row in rows)
    assert {row["worker"] for _, row in rows if row["job"] >= 10} == {workers[1].pid}


@pytest.mark.slow
def test_a_suite_gives_the_same_rows_as_here(cluster, tmp_path):
    address, _ = cluster
    words = ["bench", "random", "--missions", "2", "--json-out"]
    assert main([*words, str(tmp_path / "here.json"), "--workers", "1"]) == 0
    assert main([*words, str(tmp_path / "there.json"), "--dask", address]) == 0
    here, there = (
        re.sub(r'"(tick|command)_ms\w*": [\d.]+|"(wall|cpu)_s": [\d.]+', "", file.read_text())
        for file in (tmp_path / "here.json", tmp_path / "there.json")
    )
    assert here == there


def test_a_cluster_that_is_not_there_is_an_error_in_words(monkeypatch):
    from dynastar.bench import remote

    monkeypatch.setattr(remote, "TIMEOUT", 1)
    for address in ("tcp://127.0.0.1:9", "nonsense://:1"):
        with pytest.raises(InputError, match=rf"--dask {address}: no scheduler.*tcp://127"):
            list(completed(abs, [1], address))


def test_an_address_without_a_port_is_refused_before_a_client_is_made(monkeypatch):
    """Such a client waits for half a minute when it is deleted, and then prints a traceback."""
    import distributed

    monkeypatch.setattr(distributed, "Client", None)
    with pytest.raises(InputError, match="--dask nowhere: expected an address with its port"):
        list(completed(abs, [1], "nowhere"))
