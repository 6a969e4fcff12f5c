import pytest


@pytest.fixture
def path(tmp_path):
    """Where a test's store is."""
    return tmp_path / "results.db"
