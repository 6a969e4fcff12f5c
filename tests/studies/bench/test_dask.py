"""A real Dask scheduler and two worker processes on loopback, one of which is killed."""

import json
import os
import signal
import subprocess
import sys
import time

import dask
import distributed  # noqa: F401  (its defaults must be there before one of them is changed)
import pytest

from evenroad.datasets import dask_cluster
from evenroad.datasets.dask_cluster import dask_workers
from evenroad.datasets.workers import in_process
from evenroad.errors import InvalidValue, NotAvailable
from evenroad_studies.bench.runner import run_tasks
from evenroad_studies.bench.store import open_store, read_rows
from evenroad_studies.bench.task import Task
from tests.refused import refused
from tests.studies.bench.tables import table_of

PATIENCE = "3s"
"""For results that a dead worker has; Dask's own 30 s are long for a test."""

TASKS = tuple(
    Task(problem, 0, sampler, 128, rule, "stock", run, 3)
    for problem in ("corridor-2d-0.1", "hypercube-legacy6")
    for sampler in ("uniform", "halton paper-blocks")
    for run in range(60)
    for rule in ("k=10 earlier", "k=4 symmetrised")
)


def _start(*arguments):
    # Quiet: what the cluster logs when a worker is killed is not the test's.
    quiet = dict(stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    impatient = os.environ | {"DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT": PATIENCE}
    return subprocess.Popen([sys.executable, "-m", *arguments], env=impatient, **quiet)


@pytest.fixture(autouse=True)
def _impatient():
    with dask.config.set({"distributed.comm.timeouts.connect": PATIENCE}):
        yield


@pytest.fixture
def scheduler(tmp_path):
    """Yield the address of a scheduler without workers, a function that starts some, and all processes."""
    file = tmp_path / "scheduler.json"
    options = ("--no-dashboard", "--scheduler-file", str(file))
    running = [_start("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", *options)]

    def add_workers(*names):
        worker = ("distributed.cli.dask_worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard")
        for name in names:
            running.append(_start(*worker, "--name", name, "--local-directory", str(tmp_path / name)))

    try:
        address = _waited_for(
            lambda: file.exists() and file.read_text().endswith("}") and json.loads(file.read_text())["address"]
        )
        yield address, add_workers, running
    finally:
        for process in reversed(running):
            process.kill()
            process.wait()


def _waited_for(ask):
    for _ in range(600):
        if answer := ask():
            return answer
        time.sleep(0.1)
    raise AssertionError("a scheduler or a worker did not start")


def _killing(process, at_least):
    """Return a callback that kills a process when so many tasks are finished, and the list of when it did."""
    killed = []

    def kill(finished, tasks):
        if finished >= at_least and not killed:
            killed.append(finished)
            os.kill(process.pid, signal.SIGKILL)

    return kill, killed


def test_a_cluster_that_loses_a_worker_gives_the_table_of_one_process_and_without_its_scheduler_keeps_rows(
    scheduler, tmp_path, monkeypatch
):
    """One cluster for all, which takes seconds to start: what is refused first, then what it survives."""
    address, add_workers, running = scheduler
    with monkeypatch.context() as change:
        change.setattr(dask_cluster, "WORKER_SECONDS", 0.5)
        refused(NotAvailable, "has no workers", dask_workers, address)
    add_workers("a", "b")
    with monkeypatch.context() as change:
        change.setattr(dask_cluster, "__version__", "0.0.0")
        refused(NotAvailable, "have evenroad .*, here it is 0.0.0", dask_workers, address)
    workers = dask_workers(address)
    executor = workers.make()
    _waited_for(lambda: workers.count(executor) >= 2)
    executor.shutdown()

    kill, killed = _killing(running[1], len(TASKS) // 4)
    with open_store(tmp_path / "dask.db") as store:
        report = run_tasks("test", TASKS, store, workers, callback=kill)
    assert killed[0] < len(TASKS)
    assert (report.finished, report.failures) == (len(TASKS), 0)
    assert len(read_rows(tmp_path / "dask.db").worker.present()) == 2
    with open_store(tmp_path / "alone.db") as store:
        run_tasks("test", TASKS, store, in_process())
    assert table_of(tmp_path / "dask.db") == table_of(tmp_path / "alone.db")

    monkeypatch.setattr(dask_cluster, "CONNECT_SECONDS", 2.0)
    kill, killed = _killing(running[0], 1)
    with open_store(tmp_path / "left.db") as store, pytest.raises(NotAvailable, match="no Dask scheduler answers"):
        run_tasks("test", TASKS, store, workers, callback=kill)
    assert killed[0] <= len(read_rows(tmp_path / "left.db")) < len(TASKS)


def test_an_unreachable_scheduler_is_said_within_seconds(monkeypatch):
    monkeypatch.setattr(dask_cluster, "CONNECT_SECONDS", 1.0)
    began = time.monotonic()
    refused(NotAvailable, "no Dask scheduler answers at", dask_workers, "tcp://127.0.0.1:9")
    assert time.monotonic() - began < 20.0


@pytest.mark.parametrize("address", [
    "foo", "127.0.0.1:8786", "tcp://127.0.0.1", "tcp://:8786", "foo://host:8786", "tcp://host:8786/x",
    "tcp://a b:1", "",
])  # fmt: skip
def test_an_address_of_another_form_is_refused_with_an_example(address):
    refused(InvalidValue, "of the form tcp://host:8786", dask_workers, address)


@pytest.mark.parametrize("address", ["tcp://host.example.org:8786", "tls://10.0.0.1:1", "tcp://[::1]:8786"])
def test_addresses_of_machines_are_of_that_form(address):
    assert dask_cluster.ADDRESS.fullmatch(address)


def test_without_certificates_or_the_package_it_is_said_what_is_needed(monkeypatch):
    refused(NotAvailable, "needs certificates", dask_workers, "tls://127.0.0.1:8786")
    monkeypatch.setitem(sys.modules, "distributed", None)
    refused(NotAvailable, r"pip install 'evenroad\[dask\]'", dask_workers, "tcp://127.0.0.1:8786")
