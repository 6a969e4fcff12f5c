import pytest


@pytest.fixture(autouse=True)
def _a_cache_of_its_own(tmp_path_factory, monkeypatch):
    monkeypatch.setenv("EVENROAD_CACHE", str(tmp_path_factory.mktemp("cache")))
