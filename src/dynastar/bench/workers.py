"""Work on many jobs at once: in processes of this machine, or on a Dask cluster.

``Workers`` says where: a number of processes, the processes of a ``pool``, or the address of a cluster's
scheduler. Each job runs on one thread, so that what it measures does not depend on the number of cores.
"""

import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import Any

from tqdm import tqdm

from dynastar.errors import DynastarError

Workers = int | str | Executor
Row = dict[str, Any]

SINGLE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


def completed(
    work: Callable[[Any], Row], jobs: Sequence[Any], workers: Workers
) -> Iterator[tuple[int, Row]]:
    """The index of each job and the row that ``work`` makes of it, as they are completed.

    With one process or one job all of it happens in this process, in order. Leaving the iterator early
    ends the worker processes. Raises DynastarError if a worker process was killed, and InputError for
    a cluster that cannot be used.
    """
    if isinstance(workers, str):
        from dynastar.bench.remote import completed_remotely

        yield from completed_remotely(work, jobs, workers)
    elif isinstance(workers, Executor):
        yield from _submitted(workers, work, jobs)
    elif min(workers, len(jobs)) <= 1:
        yield from ((index, work(job)) for index, job in enumerate(jobs))
    else:
        yield from _in_processes(work, jobs, min(workers, len(jobs)))


def spread(work: Callable[[Any], Row], jobs: Sequence[Any], workers: Workers) -> Iterator[Row]:
    """The rows that ``work`` makes of the jobs, in their order."""
    waiting: dict[int, Row] = {}
    following = 0
    for index, row in completed(work, jobs, workers):
        waiting[index] = row
        while following in waiting:
            yield waiting.pop(following)
            following += 1


def _in_processes(
    work: Callable[[Any], Row], jobs: Sequence[Any], workers: int
) -> Iterator[tuple[int, Row]]:
    with pool(workers) as executor:
        yield from _submitted(executor, work, jobs)


@contextmanager
def pool(workers: int) -> Iterator[Executor]:
    """Worker processes for several calls of ``completed``; leaving early ends them.

    Raises DynastarError if one was killed.
    """
    others = set(multiprocessing.active_children())
    context = multiprocessing.get_context("spawn")
    executor = ProcessPoolExecutor(workers, context, initializer=settle)
    done = False
    try:
        yield executor
        done = True
    except BrokenProcessPool:
        raise DynastarError(
            "a worker process was killed (not enough memory?); fewer --workers need less"
        ) from None
    finally:
        executor.shutdown(wait=False, cancel_futures=True)
        while not done:  # nobody waits for the jobs that are under way
            children = set(multiprocessing.active_children()) - others
            for child in children:
                child.kill()
                child.join(timeout=1.0)
            done = not children


def _submitted(
    executor: Executor, work: Callable[[Any], Row], jobs: Sequence[Any]
) -> Iterator[tuple[int, Row]]:
    with _no_interrupt(), _single_threaded():  # processes start when jobs are submitted
        futures = {executor.submit(work, job): index for index, job in enumerate(jobs)}
    for future in as_completed(futures):
        yield futures[future], future.result()


@contextmanager
def _no_interrupt() -> Iterator[None]:
    """Holds Ctrl-C back; processes that start in the meantime never get it, also before ``settle``."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _single_threaded() -> Iterator[None]:
    """Lets processes that start in the meantime use one thread each."""
    before = {name: os.environ.get(name) for name in SINGLE_THREAD}
    os.environ.update(dict.fromkeys(SINGLE_THREAD, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def settle() -> None:
    """Prepares a worker process: one thread, Ctrl-C left to the parent, an end with the parent."""
    import cv2

    threading.Thread(target=_end_with_parent, daemon=True).start()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    cv2.setNumThreads(1)
    # Not a lock between processes, which would outlast a killed worker.
    tqdm.set_lock(threading.RLock())
    sys.stdout = sys.stderr


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()  # a parent that is killed cannot end its workers
        os._exit(1)
