import json
from dataclasses import replace

import numpy as np
import pytest
import torch

from evenroad.errors import BrokenFile
from evenroad.research.network import NetworkConfig
from evenroad.research.network import state as module
from evenroad.research.network.state import advance, first_state, load_checkpoint, save_checkpoint, tensors_of
from evenroad.research.training.objective import parse_objective

CONFIG = NetworkConfig(8, 2, sets=2, width=4, layers=1, k=2, steps=10)
CPU = torch.device("cpu")


def state_after(steps):
    state, batches = first_state(CONFIG, CPU)
    for _ in range(steps):
        advance(state, batches, CONFIG, parse_objective(CONFIG.objective))
    return state


def fresh():
    return first_state(CONFIG, CPU)[0]


def assert_same(one, other):
    for name, tensor in tensors_of(one).items():
        assert torch.equal(tensor, tensors_of(other)[name]), name
    assert (one.step, one.last_improved, one.best_mean) == (other.step, other.last_improved, other.best_mean)


@pytest.mark.parametrize("steps", [0, 1, 4])
def test_a_state_comes_back_as_it_was(tmp_path, steps):
    saved, loaded = state_after(steps), fresh()
    save_checkpoint(tmp_path, CONFIG, saved)
    assert load_checkpoint(tmp_path, CONFIG, loaded)
    assert_same(saved, loaded)


def test_a_folder_without_a_checkpoint_changes_nothing(tmp_path):
    state = fresh()
    assert not load_checkpoint(tmp_path, CONFIG, state)
    assert_same(state, fresh())


def test_a_new_checkpoint_takes_the_place_of_the_old(tmp_path):
    save_checkpoint(tmp_path, CONFIG, state_after(1))
    save_checkpoint(tmp_path, CONFIG, state_after(2))
    tensors = json.loads((tmp_path / "checkpoint.json").read_text())["tensors"]
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([tensors, "checkpoint.json"])


def test_a_kill_between_its_two_files_leaves_the_old_checkpoint(tmp_path, monkeypatch):
    old = state_after(1)
    save_checkpoint(tmp_path, CONFIG, old)

    def killed(*arguments, **options):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(module.json, "dumps", killed)
        with pytest.raises(KeyboardInterrupt):
            save_checkpoint(tmp_path, CONFIG, state_after(2))
    assert len(list(tmp_path.glob("*.safetensors"))) == 2
    loaded = fresh()
    load_checkpoint(tmp_path, CONFIG, loaded)
    assert_same(old, loaded)


def flip_a_byte(folder):
    (path,) = folder.glob("*.safetensors")
    data = bytearray(path.read_bytes())
    data[-5] ^= 1
    path.write_bytes(data)


def cut_the_tensors(folder):
    (path,) = folder.glob("*.safetensors")
    path.write_bytes(path.read_bytes()[:100])


def lose_the_tensors(folder):
    (path,) = folder.glob("*.safetensors")
    path.unlink()


def change(**entries):
    def damage(folder):
        path = folder / "checkpoint.json"
        path.write_text(json.dumps(json.loads(path.read_text()) | entries))

    return damage


def cut_the_record(folder):
    path = folder / "checkpoint.json"
    path.write_bytes(path.read_bytes()[:50])


def lose_an_entry(folder):
    path = folder / "checkpoint.json"
    record = json.loads(path.read_text())
    del record["step"]
    path.write_text(json.dumps(record))


@pytest.mark.parametrize(
    ("damage", "reason"),
    [
        (flip_a_byte, "does not match its hash"),
        (cut_the_tensors, "does not match its hash"),
        (lose_the_tensors, "No such file"),
        (cut_the_record, "JSONDecodeError"),
        (lose_an_entry, "KeyError: 'step'"),
        (change(format=2), "no checkpoint of format 1"),
        (change(step=11), "step 11"),
        (change(step="many"), "invalid literal"),
        (change(last_improved=5), "last improved at 5"),
        (change(config={}), "another config"),
        (change(tensors=None), "TypeError"),
    ],
)
def test_a_damaged_checkpoint_is_refused_and_nothing_is_loaded(tmp_path, damage, reason):
    save_checkpoint(tmp_path, CONFIG, state_after(3))
    damage(tmp_path)
    state = fresh()
    with pytest.raises(BrokenFile, match=rf"checkpoint.json cannot be resumed: .*{reason}.*resume=False"):
        load_checkpoint(tmp_path, CONFIG, state)
    assert_same(state, fresh())


def test_a_checkpoint_of_another_config_is_refused(tmp_path):
    save_checkpoint(tmp_path, CONFIG, state_after(1))
    other = replace(CONFIG, width=5)
    with pytest.raises(BrokenFile, match="another config"):
        load_checkpoint(tmp_path, other, first_state(other, CPU)[0])


def test_tensors_of_another_shape_are_refused(tmp_path):
    # As after a change of the network in a later version: the config is the same, the tensors are not.
    state = state_after(1)
    state.best_points = np.zeros((2, 8, 3))
    save_checkpoint(tmp_path, CONFIG, state)
    with pytest.raises(BrokenFile, match=r"best_points is torch.float64 \(2, 8, 3\)"):
        load_checkpoint(tmp_path, CONFIG, fresh())
