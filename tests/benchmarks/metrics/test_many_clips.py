from __future__ import annotations

import pytest

from benchmarks.metrics import frechet_distance, many_clips


def test_the_benchmark_measures_every_clip_twice_and_prints_numbers(
    capsys: pytest.CaptureFixture[str],
) -> None:
    many_clips.main(["--clips", "10", "--seconds", "1.5", "--processes", "1", "--preset", "genea"])
    lines = [line.split(": ") for line in capsys.readouterr().out.splitlines()]
    values = {name: float(value) for name, value in lines}
    assert values["clips"] == 10
    assert values["clip_scores"] == 20
    assert values["cold_clips_per_s"] > 0
    assert values["kept_clips_per_s"] > 0


def test_the_benchmark_prints_a_number_behind_every_name(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(frechet_distance, "SHAPES", ((6, 8), (30, 4)))
    frechet_distance.main()
    lines = [line.split(": ") for line in capsys.readouterr().out.splitlines()]
    assert len(lines) == 10
    assert all(float(value) > -1 for _, value in lines)
    assert lines[2][0] == "frechet_n6_d8_times_faster"
