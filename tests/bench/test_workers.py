import functools
import math
import multiprocessing
import os
import signal
import subprocess
import sys

import pytest

from dynastar.bench.workers import completed, spread
from dynastar.errors import DynastarError


def test_one_process_works_in_order_here():
    seen = []
    rows = completed(lambda job: seen.append(job) or {"job": job}, [3, 1, 2], 1)
    assert next(rows) == (0, {"job": 3})
    assert seen == [3]
    assert list(rows) == [(1, {"job": 1}), (2, {"job": 2})]


def test_processes_complete_every_job_once_and_spread_keeps_the_order():
    jobs = list(range(7))
    assert sorted(completed(math.factorial, jobs, 2)) == [(n, math.factorial(n)) for n in jobs]
    assert list(spread(math.factorial, jobs, 2)) == [math.factorial(n) for n in jobs]


def test_processes_have_one_thread_and_the_environment_stays(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    monkeypatch.delenv("NUMBA_NUM_THREADS", raising=False)
    assert set(spread(os.getenv, ["OMP_NUM_THREADS", "NUMBA_NUM_THREADS"], 2)) == {"1"}
    assert os.environ["OMP_NUM_THREADS"] == "7"
    assert "NUMBA_NUM_THREADS" not in os.environ


def test_processes_never_get_the_interrupt_that_ends_the_parent():
    mask = functools.partial(signal.pthread_sigmask, signal.SIG_BLOCK)
    before = mask(())
    assert all(signal.SIGINT in held for held in spread(mask, [(), ()], 2))
    assert mask(()) == before


def test_a_worker_that_is_killed_is_an_error_in_words():
    with pytest.raises(DynastarError, match="a worker process was killed"):
        list(completed(os._exit, [1, 1], 2))


def test_who_leaves_early_leaves_no_process_behind():
    before = set(multiprocessing.active_children())
    rows = completed(math.factorial, list(range(50)), 2)
    next(rows)
    rows.close()
    assert set(multiprocessing.active_children()) <= before


POOL = """\
import multiprocessing, os, time
from concurrent.futures import ProcessPoolExecutor
from dynastar.bench.workers import settle

if __name__ == "__main__":
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(1, context, initializer=settle)
    print(pool.submit(os.getpid).result(), flush=True)
    pool.submit(time.sleep, 3600.0).result()
"""


def test_workers_end_with_a_parent_that_is_killed(tmp_path):
    script = tmp_path / "pool.py"
    script.write_text(POOL)
    with subprocess.Popen([sys.executable, script], stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        assert int(parent.stdout.readline()) != parent.pid
        parent.kill()
        parent.communicate(timeout=300.0)  # ends when the last who holds the pipe, the worker, has
