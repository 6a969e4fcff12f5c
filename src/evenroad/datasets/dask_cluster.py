"""Workers of a Dask cluster: other machines behind one scheduler."""

from __future__ import annotations

import re
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor, Future
from typing import Any, TypeAlias

from evenroad import __version__
from evenroad._checks import require_extra
from evenroad.datasets.workers import Arguments, Result, Workers
from evenroad.errors import InvalidValue, NotAvailable

DaskClient: TypeAlias = Any
"""A client of Dask, which has no types."""
CONNECT_SECONDS = 8.0
WORKER_SECONDS = 60.0
"""How long a cluster may be without any worker: these may be just starting."""
ADDRESS = re.compile(r"(tcp|tls|wss?)://([^\s/:\[\]]+|\[[0-9a-fA-F:.]+\]):\d{1,5}")


def dask_workers(address: str) -> Workers:
    """Return the workers of a running Dask scheduler, e.g. ``tcp://host:8786``; needs the extra ``dask``.

    The cluster may be a LocalCluster, one over SSH, or one that dask-jobqueue keeps on Slurm; evenroad must be
    installed there in the same version.  A chunk whose worker dies is sent to another one by the scheduler itself,
    three times.  Tasks run in threads of the workers, so the limit on a task's seconds does not hold there.  Raises
    NotAvailable if the package is missing, or no scheduler or no workers of our version answer within a minute.
    """
    # Not left to Dask: a client that cannot read its address takes a quarter of a minute to go away, with a traceback.
    if not ADDRESS.fullmatch(address):
        raise InvalidValue(f"the address of a scheduler must be of the form tcp://host:8786, got {address!r}")
    executor = _connect(address)
    try:
        executor.require_workers()
    finally:
        executor.shutdown()
    return Workers(lambda: _connect(address), _DaskExecutor.count_threads)


def _connect(address: str) -> _DaskExecutor:
    dask = require_extra("distributed", "dask", "a Dask scheduler")
    encrypted = address.startswith(("tls:", "wss:"))
    if encrypted and dask.Security().get_connection_args("client")["ssl_context"] is None:
        raise NotAvailable(f"{address!r} needs certificates, which Dask's configuration has none of")
    try:
        client = dask.Client(address, timeout=CONNECT_SECONDS, set_as_default=False)
    except (OSError, ValueError) as error:
        raise NotAvailable(
            f"no Dask scheduler answers at {address!r} within {CONNECT_SECONDS:g} s: is it running there? ({error})"
        ) from error
    return _DaskExecutor(client, address)


class _DaskExecutor(Executor):
    """Dask's own executor, on a client that it closes."""

    def __init__(self, client: DaskClient, address: str) -> None:
        self._client, self._address = client, address
        self._executor = client.get_executor(pure=False)

    def require_workers(self) -> None:
        """Refuse a cluster that has no workers, or others than ours."""
        try:
            self._client.wait_for_workers(1, timeout=WORKER_SECONDS)
        except TimeoutError:
            raise NotAvailable(f"the Dask scheduler at {self._address} has no workers") from None
        versions = set(self._client.run(_version).values())
        if versions != {__version__}:
            raise NotAvailable(
                f"the workers at {self._address} have evenroad {', '.join(sorted(versions))}, here it is {__version__}"
            )

    def count_threads(self) -> int:
        """Return how many tasks the cluster runs at a time now, at least 1."""
        try:
            threads: int = sum(self._client.nthreads().values())
            return max(1, threads)
        except OSError:
            # The connection is lost, as the next call that is submitted will say.
            return 1

    def submit(
        self, fn: Callable[Arguments, Result], /, *args: Arguments.args, **kwargs: Arguments.kwargs
    ) -> Future[Result]:
        """Submit a call; BrokenExecutor if the scheduler is gone."""
        if self._client.status != "running":
            raise BrokenExecutor(f"the connection to the scheduler at {self._address} was lost")
        future: Future[Result] = self._executor.submit(fn, *args, **kwargs)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Cancel or wait for what is in flight, and close the connection; the cluster goes on."""
        if self._client.status == "running":
            self._executor.shutdown(wait=wait)
        self._client.close(timeout=CONNECT_SECONDS)


def _version() -> str:
    """Say, on a worker, which evenroad it has."""
    return __version__
