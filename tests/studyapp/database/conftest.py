import pytest

from studyapp.database.sqlite import keep_private


@pytest.fixture(autouse=True)
def _new_databases_are_migrated(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make every new database of these tests by migrations, and none as a copy."""
    monkeypatch.setattr("studyapp.database.engine.keep_private", keep_private)
