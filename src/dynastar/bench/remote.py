"""Jobs on an existing Dask cluster (extra ``dask``).

The cluster's workers need the same version of dynastar's code and the data under the same paths. Dask
runs a job again whose worker has died; every job's row is handed on once.
"""

import re
import threading
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any

from dynastar.errors import DynastarError, InputError
from dynastar.extras import how_to_install

Row = dict[str, Any]

EXAMPLE = "tcp://127.0.0.1:8786"
TIMEOUT = 15  # s to connect
RETRIES = 2  # further attempts at a job that raised because of the cluster

_one_at_a_time = threading.Lock()


def completed_remotely(
    work: Callable[[Any], Row], jobs: Sequence[Any], address: str
) -> Iterator[tuple[int, Row]]:
    """The index of each job and its row as they are completed on the cluster at ``address``.

    Raises InputError if Dask is not installed, the scheduler cannot be reached, it has no workers, or
    a worker has another version of the code; DynastarError if a job kills one worker after the other,
    or the scheduler is lost.
    """
    client = _client(address)
    try:
        _check_workers(client, address)
        from distributed import CancelledError, KilledWorker, as_completed

        calls = client.map(partial(_alone, work), list(jobs), pure=False, retries=RETRIES)
        index_of = {future.key: index for index, future in enumerate(calls)}
        for future in as_completed(calls, loop=client.loop):
            # A result that was lost with its worker is computed again, and the key comes twice.
            index = index_of.pop(future.key, None)
            if index is None:
                continue
            try:
                row = future.result()
            except KilledWorker:
                raise DynastarError(f"--dask: every worker that took job {index} died") from None
            except CancelledError:
                raise DynastarError(f"--dask {address}: the scheduler was lost") from None
            yield index, row
    finally:
        client.close()


def jobs_at_once(address: str) -> int:
    """The number of jobs that a cluster does at once. Raises InputError as ``completed_remotely``."""
    client = _client(address)
    try:
        _check_workers(client, address)
        return len(client.nthreads())  # each process does one at a time
    finally:
        client.close()


def _client(address: str) -> Any:
    try:
        from distributed import Client
    except ImportError:
        raise InputError(f"--dask needs Dask: {how_to_install('dask')}") from None
    if not re.search(r":\d+$", address):  # such a client raises again when it is deleted
        raise InputError(f"--dask {address}: expected an address with its port, as {EXAMPLE}")
    try:
        return Client(address, timeout=TIMEOUT, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(
            f"--dask {address}: no scheduler answers there ({error!s:.100}); expected its address, as in "
            f"{EXAMPLE}"
        ) from None


def _check_workers(client: Any, address: str) -> None:
    from dynastar.bench.versions import code_version

    try:
        found = client.run(code_version)
    except ImportError as error:
        raise InputError(f"--dask {address}: a worker lacks a package: {error}") from None
    if not found:
        raise InputError(f"--dask {address}: the cluster has no workers")
    here = code_version()
    others = [worker for worker, there in found.items() if there != here]
    if others:
        raise InputError(
            f"--dask {address}: the worker {others[0]} has another version of dynastar's code; install "
            "the same one everywhere"
        )


def _alone(work: Callable[[Any], Row], job: Any) -> Row:
    """Does a job on one thread, one job at a time in each process."""
    import cv2

    with _one_at_a_time:
        cv2.setNumThreads(1)
        return work(job)
