import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.points import draw, load_points
from evenroad.points.bank import Bank
from evenroad.points.measures import MEASURES, separation, star_discrepancy
from evenroad_studies.network import NetworkConfig, train
from evenroad_studies.network.train import kronecker
from evenroad_studies.training import train_many
from evenroad_studies.training.objective import Objective, parse_objective

TINY = NetworkConfig(16, 2, width=8, layers=2, k=3, steps=40)
HICKERNELL = MEASURES["hickernell"].rooted


def stored(family, n, d):
    """Return the sets of the bank at one n and d, (sets, n, d)."""
    return Bank().cell(family, n, d).load().astype(float)


def test_the_network_makes_its_start_better_and_says_how_good_it_is():
    made = train(NetworkConfig(32, 2, steps=300), rng=1)
    assert made.value == pytest.approx(HICKERNELL(made.points), rel=1e-9)
    assert made.value < 0.9 * HICKERNELL(kronecker(32, np.random.default_rng(1).random(2)))


@pytest.mark.parametrize(("d", "share"), [(2, 1.02), (3, 1.1)])
def test_seconds_come_to_annealing_in_the_plane_and_near_it_in_space(d, share):
    n = 64 if d == 2 else 128
    annealed = np.mean([HICKERNELL(points) for points in stored("hickernell", n, d)])
    assert train(NetworkConfig(n, d, steps=1500 if d == 2 else 700)).value < share * annealed


def test_the_pools_of_the_plane_are_below_annealing_and_further_apart():
    for n in (32, 64, 128, 256):
        network, annealed = stored("mpmc", n, 2), stored("hickernell", n, 2)
        assert np.mean([*map(HICKERNELL, network)]) < np.mean([*map(HICKERNELL, annealed)])
        apart, near = (np.mean([separation(points, periodic=True) for points in sets]) for sets in (network, annealed))
        assert apart > 1.5 * near


def test_the_first_step_is_nearly_the_start_and_noise_moves_it_on():
    start = draw("uniform", 16, 2, rng=np.random.default_rng(3)).points
    still = train(NetworkConfig(16, 2, start="uniform", steps=1), rng=3)
    assert np.abs(still.points - start).max() < 0.2
    quiet, noisy = (train(NetworkConfig(16, 2, steps=20, noise=noise), rng=3) for noise in (0.0, 2.0))
    assert not np.array_equal(quiet.points, noisy.points)


def test_the_points_are_the_best_of_all_steps():
    values = []
    # So large a rate makes points worse and better by turns.
    made = train(NetworkConfig(16, 2, steps=60, rate=0.3), callback=lambda step, steps, best: values.append(best))
    assert made.value == values[-1] == min(values)
    assert np.diff(values).max() <= 0
    assert len(values) == 60
    assert not made.points.flags.writeable


def test_the_exact_star_discrepancy_may_judge_which_points_are_the_best():
    by_loss, by_star = (train(NetworkConfig(20, 2, "star", steps=300, judge=j)) for j in ("objective", "star"))
    assert by_star.value == star_discrepancy(by_star.points) < star_discrepancy(by_loss.points)


@pytest.mark.parametrize(("n", "published"), [(60, 0.0273), (100, 0.0188), (140, 0.0137)])
def test_a_second_of_the_network_is_below_the_published_sets_of_mpmc(n, published):
    assert train(NetworkConfig(n, 2, "star", steps=1000, judge="star")).value < published


@pytest.mark.parametrize("d", [1, 2, 3, 7])
def test_kronecker_points_are_multiples_of_one_step_modulo_1(d):
    shift = np.random.default_rng(d).random(d)
    points = kronecker(50, shift)
    assert points.shape == (50, d)
    assert points[0] == pytest.approx([shift[0] / 50, *shift[1:]])
    steps = np.diff(points, axis=0) % 1.0
    assert steps == pytest.approx(np.broadcast_to(steps[0], steps.shape))
    if d > 1:
        g = 1.0 / steps[0, 1]
        assert g**d == pytest.approx(g + 1.0)
        assert steps[0, 1:] == pytest.approx(g ** -np.arange(1.0, d))


def test_the_same_seed_gives_the_same_bits_and_another_one_others():
    assert np.array_equal(train(TINY, rng=5).points, train(TINY, rng=5).points)
    assert not np.array_equal(train(TINY, rng=5).points, train(TINY, rng=6).points)


@pytest.mark.parametrize("objective", ["star", "hickernell+10*riesz", "average_squared"])
def test_other_objectives_train_as_well(objective):
    seen = []
    train(NetworkConfig(16, 2, objective, steps=60), callback=lambda step, steps, best: seen.append(best))
    assert seen[-1] < seen[0]


def test_a_training_that_diverges_says_so(monkeypatch):
    monkeypatch.setattr(Objective, "of_columns", lambda self, columns: (np.nan, columns))
    with pytest.raises(InvalidValue, match="diverged"):
        train(TINY)


def test_many_sets_have_their_origins_and_their_folder_is_not_that_of_another_network(tmp_path):
    """In how many processes, and what is left of a stopped training: as of sets that are annealed."""
    made = train_many(TINY, 2, rng=5, workers=1, folder=tmp_path)
    assert [load_points(tmp_path / f"set-000{i}.npz") for i in range(2)] == list(made)
    for index, points in enumerate(made):
        origin = points.origin
        assert (origin.family, origin.method, origin.objective) == ("mpmc", "network", "hickernell")
        assert (origin.seed, origin.replica) == (5, index)
    child = np.random.SeedSequence(5, spawn_key=(1,))
    assert np.array_equal(made[1].points, train(TINY, rng=child).points)
    with pytest.raises(InvalidValue, match="network"):
        train_many(NetworkConfig(16, 2, width=9, steps=40), 2, rng=5, workers=1, folder=tmp_path)


def test_sets_of_many_points_stay_inside_the_cube():
    made = train(NetworkConfig(64, 3, start="uniform", steps=5, rate=30.0))
    assert made.points.min() > 0
    assert np.float32(made.points.max()) < 1
    assert parse_objective("hickernell").value(made.points) == pytest.approx(made.value)
