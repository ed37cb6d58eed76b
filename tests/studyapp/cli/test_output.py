import sys
import time
from pathlib import Path

import pytest

from studyapp.cli.output import progress
from studyapp.desk.jobs import PROGRESS_FILE, Progress


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Return a list that holds the time."""
    now = [0.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    return now


def test_without_a_terminal_progress_is_printed_as_lines(
    clock: list[float], capsys: pytest.CaptureFixture[str]
) -> None:
    with progress("render", "frame") as show:
        show(0, 0, "0 of 0 videos")
    with progress("render", "frame") as show:
        clock[0] += 100
        show(100, 1000)
        for done in range(200, 1001, 100):
            clock[0] += 10
            show(done, 1000, f"{done // 100} of 10 videos, 1 failed")
    assert capsys.readouterr().err.splitlines() == [
        "render: 100 of 1000 frames",
        "render: 400 of 1000 frames, 10 per second, about 01:00 left, 4 of 10 videos, 1 failed",
        "render: 700 of 1000 frames, 10 per second, about 00:30 left, 7 of 10 videos, 1 failed",
        "render: 1000 of 1000 frames, 10 per second, 10 of 10 videos, 1 failed",
    ]


def test_a_terminal_gets_a_bar_with_rate_and_time_left(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    with progress("render", "frame") as show:
        show(0, 200)
        show(200, 200, "4 of 4 videos")
    bar = capsys.readouterr().err.split("\r")[-1]
    assert "200/200" in bar
    assert "frame/s" in bar
    assert "4 of 4 videos" in bar


def test_progress_is_also_written_to_a_file(
    clock: list[float], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "progress.json"
    monkeypatch.setenv(PROGRESS_FILE, str(file))

    def stored() -> Progress:
        return Progress.model_validate_json(file.read_bytes())

    with progress("render", "frame") as show:
        show(0, 400)
        assert stored().words == "render: 0 of 400 frames"
        clock[0] += 0.5
        show(100, 400)
        assert stored().done == 0
        clock[0] += 0.5
        show(200, 400)
        assert (stored().done, stored().total) == (200, 400)
        assert stored().words == "render: 200 of 400 frames, 200 per second, about 00:01 left"
