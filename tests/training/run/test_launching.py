import pytest

from training.run.launching import group_size, is_leader


def test_without_a_launcher_a_process_is_its_own_leader(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("WORLD_SIZE", "RANK", "LOCAL_RANK"):
        monkeypatch.delenv(name, raising=False)
    assert (group_size(), is_leader()) == (1, True)
    # Set by batch systems for other reasons.
    monkeypatch.setenv("WORLD_SIZE", "4")
    monkeypatch.setenv("RANK", "2")
    assert (group_size(), is_leader()) == (1, True)
    monkeypatch.setenv("LOCAL_RANK", "2")
    assert (group_size(), is_leader()) == (4, False)
