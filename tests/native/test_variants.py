"""The builds of the native kernel: which one is loaded, and that all give the same answers."""

import os
import subprocess
import sys

import numpy as np
import pytest

from evenroad import _native
from evenroad._native import variants
from evenroad._native.digest import digest_of
from evenroad.errors import NotAvailable, UnknownName

USABLE = variants.usable()
RELEASED = [each for each in USABLE if each != variants.SANITIZED]
OTHERS = [each for each in RELEASED if each != _native.VARIANT]
"""A build from source has one alone; EVENROAD_VARIANTS=all makes the others."""


def test_the_newest_build_that_the_processor_runs_is_loaded(monkeypatch):
    monkeypatch.delenv(variants.ENVIRONMENT, raising=False)
    assert USABLE[-1] == variants.load().VARIANT
    assert USABLE[-1] != variants.SANITIZED


@pytest.mark.parametrize("variant", RELEASED)
def test_the_environment_chooses_the_build(variant):
    code = "from evenroad import _native; print(_native.VARIANT)"
    environment = {**os.environ, variants.ENVIRONMENT: variant}
    loaded = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert loaded.stdout.strip() == variant


def test_an_unknown_build_is_refused_with_those_that_are_there(monkeypatch):
    monkeypatch.setenv(variants.ENVIRONMENT, "ia64")
    with pytest.raises(UnknownName, match=f"EVENROAD_ARCH 'ia64'; known: {', '.join(USABLE)}"):
        variants.load()


def test_a_clone_without_the_kernel_says_how_to_build_it(monkeypatch):
    monkeypatch.setattr(variants, "import_module", lambda name: __import__("evenroad._native.not_there"))
    with pytest.raises(NotAvailable, match="make native"):
        variants.usable()


def test_a_clone_whose_kernel_is_for_other_processors_says_so(monkeypatch):
    monkeypatch.setattr(variants, "find_spec", lambda name: None)
    with pytest.raises(NotAvailable, match="for other processors than this, .*: run `make native`"):
        variants.usable()


def test_a_kernel_of_other_sources_is_not_loaded(monkeypatch, tmp_path):
    part = tmp_path / "common"
    part.mkdir()
    (part / "lanes.hpp").write_text("changed")
    monkeypatch.delenv(variants.ENVIRONMENT, raising=False)
    monkeypatch.setattr(variants, "SOURCES", str(tmp_path))
    with pytest.raises(NotAvailable, match="is built from other sources than .*: run `make native`"):
        variants.load()
    monkeypatch.setattr(variants, "SOURCES", str(tmp_path / "of a wheel, which has none"))
    assert USABLE[-1] == variants.load().VARIANT


def test_the_digest_sees_a_changed_and_a_renamed_source(tmp_path):
    part = tmp_path / "common"
    part.mkdir()
    seen = []
    for name, text in (("a.hpp", "1"), ("a.hpp", "2"), ("b.hpp", "2")):
        for old in part.iterdir():
            old.unlink()
        (part / name).write_text(text)
        (part / "notes.txt").write_text(f"no source: {len(seen)}")
        seen.append(digest_of(str(tmp_path)))
    assert len(set(seen)) == 3
    (part / "notes.txt").write_text("of another length")
    assert digest_of(str(tmp_path)) == seen[-1]


@pytest.mark.parametrize("variant", OTHERS)
def test_maps_and_neighbours_are_the_same_bits_in_every_build(variant, monkeypatch):
    """Of verdicts, places and paths: no sum of theirs is fused, so all builds round alike."""
    monkeypatch.setenv(variants.ENVIRONMENT, variant)
    rng = np.random.default_rng(5)
    occupied = rng.random((60, 80)) < 0.04
    a, b = rng.random((2, 400, 2)) * (80.0, 60.0)
    found = []
    for kernel in (_native.kernel, variants.load()):
        disk = kernel.world.Disk(occupied, np.array([0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0]), 1.3)
        start, *goals = a[disk.points_free(a)]
        path = disk.find_path(start, np.array(goals[-2:]), 10_000)
        counts = path.goal, path.expanded, path.motions
        near = kernel.roadmap.k_nearest(a, np.array([80.0, np.inf]), 7, False)
        far = kernel.space.flat_distances(a, b, np.ones(2), np.array([80.0, np.inf]))
        found.append((disk.motions_free(a, b), disk.nearest_obstacles(a)[0], path.points, counts, near, far))
    assert 0.02 < found[0][0].mean() < 0.98
    assert len(found[0][2]) > 2
    for one, other in zip(*found, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.skipif(_native.VARIANT == variants.SANITIZED, reason="its blocks are narrower")
@pytest.mark.parametrize("variant", OTHERS)
def test_sums_of_pairs_are_the_same_bits_in_every_build(variant, monkeypatch):
    monkeypatch.setenv(variants.ENVIRONMENT, variant)
    points = variants.load().points
    columns, ones = np.random.default_rng(1).random((5, 301)), np.ones(5)
    kernels, pairs = (_native.points, points), (2 * ones, ones, 0.5 * ones, 0.1 * columns, np.zeros_like(columns))
    for one, other in (
        [each.maximum_pair_sums(columns, 2 * ones, ones, True) for each in kernels],
        [each.distance_pair_sums(columns, *pairs, True) for each in kernels],
    ):
        np.testing.assert_array_equal(one.sums, other.sums)
        np.testing.assert_array_equal(one.gradient, other.gradient)
