import importlib
import json
import math
import signal
import subprocess
import sys
import time
from dataclasses import asdict, replace

import numpy as np
import pytest
import torch

from evenroad.errors import BrokenFile, InvalidValue, NotAvailable
from evenroad.points import load_points
from evenroad.research.network import NetworkConfig, train
from evenroad.research.network.config import choose_device
from evenroad.research.network.state import TrainingState, advance, first_state, is_finished, learning_rate
from evenroad.research.training import anneal_many
from evenroad.research.training.objective import parse_objective

TINY = NetworkConfig(16, 2, sets=3, width=8, layers=2, k=3, steps=40, seed=5)


class Stop(Exception):
    pass


def stop_at(last):
    def callback(step, steps, best):
        if step == last:
            raise Stop

    return callback


def train_on_cpu(config=TINY, **options):
    return train(config, device="cpu", **options)


def points_of(sets):
    return np.stack([each.points for each in sets])


def test_the_result_is_one_point_set_a_replica_with_its_origin():
    sets = train_on_cpu()
    assert len(sets) == 3
    for index, points in enumerate(sets):
        assert points.points.shape == (16, 2)
        assert points.points.dtype == np.float64
        origin = points.origin
        assert (origin.family, origin.method, origin.objective) == ("mpmc", "network", "hickernell")
        assert (origin.seed, origin.replica) == (5, index)


def test_training_makes_the_sets_much_better_than_random_ones():
    sets = train_on_cpu(replace(TINY, width=32, steps=300))
    discrepancy = parse_objective("hickernell").value
    random_mean = np.mean([discrepancy(each) for each in np.random.default_rng(0).random((20, 16, 2))])
    assert all(discrepancy(each.points) < random_mean / 3 for each in sets)


def test_the_points_are_the_best_of_all_steps_not_those_of_the_last():
    # So large a rate makes points worse and better by turns.
    config = replace(TINY, rate=0.3)
    objective = parse_objective(config.objective)
    state, (batch,) = first_state(config, torch.device("cpu"))
    seen, values = [], []
    for _ in range(15):
        with torch.no_grad():
            seen.append(state.network(batch.starts, batch.sender, batch.receiver).numpy())
        values.append([objective.value(each) for each in seen[-1]])
        advance(state, (batch,), config, objective)
    best_steps = np.argmin(values, axis=0)
    assert (best_steps != 14).any()
    for index, step in enumerate(best_steps):
        assert np.array_equal(state.best_points[index], seen[step][index])
        assert state.best_values[index] == values[step][index]
    assert state.best_mean == pytest.approx(np.mean(values, axis=1).min())
    assert state.last_improved == np.mean(values, axis=1).argmin() + 1


def test_the_callback_counts_every_step():
    seen = []
    train_on_cpu(callback=lambda step, steps, best: seen.append((step, steps, math.isfinite(best))))
    assert seen == [(step, 40, True) for step in range(1, 41)]


def test_the_same_seed_gives_the_same_bits_and_another_one_others():
    assert np.array_equal(points_of(train_on_cpu()), points_of(train_on_cpu()))
    assert not np.array_equal(points_of(train_on_cpu()), points_of(train_on_cpu(replace(TINY, seed=6))))


@pytest.mark.parametrize("micro_batch", [1, 2])
def test_micro_batches_add_up_to_the_whole_batch(micro_batch):
    whole, parts = [], []
    config = replace(TINY, steps=5)
    train_on_cpu(config, callback=lambda step, steps, best: whole.append(best))
    train_on_cpu(
        replace(config, micro_batch=micro_batch), callback=lambda step, steps, best: parts.append(best)
    )
    np.testing.assert_allclose(parts, whole, rtol=1e-4)


@pytest.mark.parametrize(
    "changes", [{"objective": "star"}, {"objective": "hickernell+10*riesz"}, {"radius": 0.35}]
)
def test_other_objectives_and_graphs_train_as_well(changes):
    seen = []
    train_on_cpu(replace(TINY, **changes), callback=lambda step, steps, best: seen.append(best))
    assert seen[-1] < seen[0]


def test_a_training_that_does_not_improve_stops_early():
    steps = []
    # At this rate nothing moves, so that no mean after the first is better by more than rounding.
    config = replace(TINY, rate=1e-30, weight_decay=0.0, patience=7)
    train_on_cpu(config, callback=lambda step, steps_, best: steps.append(step))
    assert steps[-1] == 8


def test_patience_counts_from_the_last_improvement():
    state = TrainingState(None, None, None, None, step=30, last_improved=21)
    assert not is_finished(state, replace(TINY, patience=10))
    assert is_finished(state, replace(TINY, patience=9))
    assert not is_finished(state, replace(TINY, patience=None))
    state.step = 40
    assert is_finished(state, replace(TINY, patience=None))


def test_the_rate_falls_along_a_half_cosine():
    rates = [learning_rate(step, TINY) for step in range(1, 41)]
    assert rates[0] == TINY.rate
    assert rates[20] == pytest.approx(TINY.rate / 2)
    assert rates == sorted(rates, reverse=True)
    assert rates[-1] > 0


def test_a_stopped_training_resumes_bit_for_bit(tmp_path):
    whole = train_on_cpu()
    with pytest.raises(Stop):
        train_on_cpu(folder=tmp_path, callback=stop_at(20))
    steps = []
    resumed = train_on_cpu(folder=tmp_path, callback=lambda step, steps_, best: steps.append(step))
    assert steps == list(range(21, 41))
    assert np.array_equal(points_of(resumed), points_of(whole))


def test_resuming_many_times_changes_nothing(tmp_path):
    for last in (1, 2, 17, 39):
        with pytest.raises(Stop):
            train_on_cpu(folder=tmp_path, callback=stop_at(last))
    assert np.array_equal(points_of(train_on_cpu(folder=tmp_path)), points_of(train_on_cpu()))


def test_a_finished_folder_is_read_not_trained(tmp_path):
    first = train_on_cpu(folder=tmp_path)
    assert sorted(path.name for path in tmp_path.glob("set-*")) == [f"set-000{i}.npz" for i in range(3)]
    assert load_points(tmp_path / "set-0002.npz") == first[2]

    def refuse(step, steps, best):
        raise AssertionError("nothing is to be trained")

    assert train_on_cpu(folder=tmp_path, callback=refuse) == first
    # A damaged set is written again from the last checkpoint.
    (tmp_path / "set-0001.npz").write_bytes(b"damaged")
    assert train_on_cpu(folder=tmp_path, callback=refuse) == first
    assert load_points(tmp_path / "set-0001.npz") == first[1]


def test_without_resume_a_training_starts_over(tmp_path):
    first = train_on_cpu(folder=tmp_path)
    steps = []
    again = train_on_cpu(
        folder=tmp_path, resume=False, callback=lambda step, steps_, best: steps.append(step)
    )
    assert steps[0] == 1
    assert again == first


def test_a_folder_of_another_training_is_refused(tmp_path):
    train_on_cpu(folder=tmp_path)
    with pytest.raises(InvalidValue, match="holds sets with rate=0.001, asked for rate=0.002"):
        train_on_cpu(replace(TINY, rate=0.002), folder=tmp_path)


def test_folders_of_annealed_and_trained_sets_do_not_mix(tmp_path):
    (tmp_path / "annealed").mkdir()
    (tmp_path / "trained").mkdir()
    anneal_many(16, 2, sets=3, steps=5, workers=1, folder=tmp_path / "annealed")
    train_on_cpu(folder=tmp_path / "trained")
    with pytest.raises(InvalidValue, match="use another folder"):
        train_on_cpu(folder=tmp_path / "annealed")
    with pytest.raises(InvalidValue, match="use another folder"):
        anneal_many(16, 2, sets=3, steps=5, workers=1, folder=tmp_path / "trained")


def test_a_set_file_of_something_else_is_refused(tmp_path):
    first = train_on_cpu(folder=tmp_path)
    other = load_points(tmp_path / "set-0000.npz")
    (tmp_path / "set-0001.npz").write_bytes((tmp_path / "set-0000.npz").read_bytes())
    assert other == first[0]
    with pytest.raises(InvalidValue, match="set-0001.npz holds another set"):
        train_on_cpu(folder=tmp_path)


def test_a_missing_folder_is_an_error_before_any_step(tmp_path):
    with pytest.raises(BrokenFile, match="does not exist"):
        train_on_cpu(folder=tmp_path / "missing")


def test_a_request_that_is_no_json_is_an_error(tmp_path):
    (tmp_path / "request.json").write_text("{")
    with pytest.raises(BrokenFile, match="request.json is not readable as JSON"):
        train_on_cpu(folder=tmp_path)


def test_a_killed_training_leaves_a_checkpoint_that_resumes_bit_for_bit(tmp_path):
    config = replace(TINY, steps=400)
    script = (
        "from evenroad.research.network import NetworkConfig, train\n"
        f"train(NetworkConfig(**{asdict(config)!r}), folder={str(tmp_path)!r}, device='cpu',"
        " checkpoint_seconds=0)\n"
    )
    process = subprocess.Popen([sys.executable, "-c", script])
    try:
        deadline = time.monotonic() + 60
        while not (tmp_path / "checkpoint.json").exists():
            assert process.poll() is None, "the training ended before it was killed"
            assert time.monotonic() < deadline, "no checkpoint in a minute"
            time.sleep(0.01)
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait()
    done = json.loads((tmp_path / "checkpoint.json").read_text())["step"]
    steps = []
    resumed = train_on_cpu(config, folder=tmp_path, callback=lambda step, steps_, best: steps.append(step))
    assert steps[0] == done + 1 > 1
    assert np.array_equal(points_of(resumed), points_of(train_on_cpu(config)))


def test_torch_is_left_as_it_was():
    before = (
        torch.get_num_threads(),
        torch.are_deterministic_algorithms_enabled(),
        torch.utils.deterministic.fill_uninitialized_memory,
        torch.get_rng_state().tolist(),
    )
    train_on_cpu(replace(TINY, steps=2))
    assert before == (
        torch.get_num_threads(),
        torch.are_deterministic_algorithms_enabled(),
        torch.utils.deterministic.fill_uninitialized_memory,
        torch.get_rng_state().tolist(),
    )


@pytest.mark.parametrize("name", ["gpu", "cpu:0", "cuda:", "cuda:x", "", None])
def test_a_device_that_is_none_is_refused(name):
    with pytest.raises(InvalidValue, match="device must be auto, cpu, cuda"):
        train(TINY, device=name)


@pytest.mark.parametrize(("is_there", "kind"), [(True, "cuda"), (False, "cpu")])
def test_auto_takes_a_gpu_when_there_is_one(monkeypatch, is_there, kind):
    monkeypatch.setattr(torch.cuda, "is_available", lambda: is_there)
    assert choose_device("auto").type == kind


def test_auto_trains_on_whatever_is_here(tmp_path):
    # Where there is a GPU this runs on it, checkpoint and resume included.
    seen = []
    with pytest.raises(Stop):
        train(TINY, folder=tmp_path, callback=stop_at(20))
    sets = train(TINY, folder=tmp_path, callback=lambda step, steps, best: seen.append(best))
    assert len(seen) == 20
    assert np.mean([parse_objective("hickernell").value(each.points) for each in sets]) <= seen[-1]


def test_a_gpu_that_is_not_there_is_not_available():
    with pytest.raises(NotAvailable, match="cuda:99"):
        train(TINY, device="cuda:99")


@pytest.mark.parametrize("options", [{"threads": 0}, {"checkpoint_seconds": -1.0}])
def test_options_out_of_range_are_refused_by_name(options):
    with pytest.raises(InvalidValue, match=f"{next(iter(options))} must be"):
        train_on_cpu(**options)


@pytest.mark.parametrize("missing", ["torch", "safetensors"])
def test_without_its_extra_the_import_says_what_to_install(monkeypatch, missing):
    for name in [name for name in sys.modules if name.startswith("evenroad.research.network")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(NotAvailable, match=rf"needs {missing}.*pip install 'evenroad\[train\]'"):
        importlib.import_module("evenroad.research.network")
