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

from evenroad.errors import InvalidValue, NotAvailable
from evenroad_studies.bench import schedulers
from evenroad_studies.bench.runner import run_tasks
from evenroad_studies.bench.schedulers import dask_workers
from evenroad_studies.bench.store import open_store, read_rows
from evenroad_studies.bench.task import Task
from evenroad_studies.workers import in_process
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
def cluster(tmp_path):
    """Yield the scheduler's address and the processes: the scheduler, then two workers."""
    file = tmp_path / "scheduler.json"
    options = ("--no-dashboard", "--scheduler-file", str(file))
    scheduler = _start("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", *options)
    running = [scheduler]
    try:
        address = _address(file, scheduler)
        worker = ("distributed.cli.dask_worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard")
        for name in ("a", "b"):
            folder = ("--local-directory", str(tmp_path / name))
            running.append(_start(*worker, "--name", name, *folder))
        yield address, running
    finally:
        for process in reversed(running):
            process.kill()
            process.wait()


def _address(file, scheduler):
    for _ in range(600):
        assert scheduler.poll() is None, "the scheduler did not start"
        if file.exists() and file.read_text().endswith("}"):
            return json.loads(file.read_text())["address"]
        time.sleep(0.1)
    raise AssertionError("the scheduler wrote no file")


def _wait_for(count, workers, executor):
    for _ in range(600):
        if workers.count(executor) >= count:
            return
        time.sleep(0.1)
    raise AssertionError("a worker did not start")


def test_a_cluster_that_loses_a_worker_gives_the_same_table_as_one_process(cluster, tmp_path):
    address, processes = cluster
    workers = dask_workers(address)
    executor = workers.make()
    _wait_for(2, workers, executor)
    executor.shutdown()
    killed = []

    def kill_one(finished, tasks):
        if finished >= len(TASKS) // 4 and not killed:
            killed.append(finished)
            os.kill(processes[1].pid, signal.SIGKILL)

    with open_store(tmp_path / "dask.db") as store:
        report = run_tasks("test", TASKS, store, workers, callback=kill_one)
    assert killed[0] < len(TASKS)
    assert (report.finished, report.failures) == (len(TASKS), 0)
    assert len(read_rows(tmp_path / "dask.db").worker.present()) == 2
    with open_store(tmp_path / "alone.db") as store:
        run_tasks("test", TASKS, store, in_process())
    assert table_of(tmp_path / "dask.db") == table_of(tmp_path / "alone.db")


def test_a_scheduler_that_goes_away_ends_the_run_and_keeps_its_rows(cluster, tmp_path, monkeypatch):
    monkeypatch.setattr(schedulers, "CONNECT_SECONDS", 2.0)
    address, processes = cluster
    workers = dask_workers(address)
    scheduler = []

    def kill_scheduler(finished, tasks):
        if finished and not scheduler:
            scheduler.append(finished)
            os.kill(processes[0].pid, signal.SIGKILL)

    with (
        open_store(tmp_path / "dask.db") as store,
        pytest.raises(NotAvailable, match="no Dask scheduler answers"),
    ):
        run_tasks("test", TASKS, store, workers, callback=kill_scheduler)
    assert scheduler[0] <= len(read_rows(tmp_path / "dask.db")) < len(TASKS)


def test_workers_of_another_version_are_refused(cluster, monkeypatch):
    address, _ = cluster
    monkeypatch.setattr(schedulers, "__version__", "0.0.0")
    with pytest.raises(NotAvailable, match="have evenroad .*, here it is 0.0.0"):
        dask_workers(address)


def test_a_scheduler_without_workers_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(schedulers, "WORKER_SECONDS", 0.5)
    file = tmp_path / "scheduler.json"
    options = ("--no-dashboard", "--scheduler-file", str(file))
    scheduler = _start("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", *options)
    try:
        with pytest.raises(NotAvailable, match="has no workers"):
            dask_workers(_address(file, scheduler))
    finally:
        scheduler.kill()
        scheduler.wait()


def test_an_unreachable_scheduler_is_said_within_seconds(monkeypatch):
    monkeypatch.setattr(schedulers, "CONNECT_SECONDS", 1.0)
    began = time.monotonic()
    with pytest.raises(NotAvailable, match="no Dask scheduler answers at"):
        dask_workers("tcp://127.0.0.1:9")
    assert time.monotonic() - began < 20.0


def test_without_the_package_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(NotAvailable, match=r"pip install 'evenroad\[dask\]'"):
        dask_workers("tcp://127.0.0.1:8786")


@pytest.mark.parametrize(
    "address",
    [
        "foo",
        "127.0.0.1:8786",
        "tcp://127.0.0.1",
        "tcp://:8786",
        "foo://host:8786",
        "tcp://host:8786/x",
        "tcp://a b:1",
        "",
    ],
)
def test_an_address_of_another_form_is_refused_with_an_example(address):
    with pytest.raises(InvalidValue, match="of the form tcp://host:8786"):
        dask_workers(address)


@pytest.mark.parametrize("address", ["tcp://host.example.org:8786", "tls://10.0.0.1:1", "tcp://[::1]:8786"])
def test_addresses_of_machines_are_of_that_form(address):
    assert schedulers.ADDRESS.fullmatch(address)


def test_an_encrypted_connection_without_certificates_is_refused():
    with pytest.raises(NotAvailable, match="needs certificates"):
        dask_workers("tls://127.0.0.1:8786")
