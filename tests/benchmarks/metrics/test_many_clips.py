from __future__ import annotations

import pytest

from benchmarks.metrics import many_clips


def test_the_benchmark_measures_every_clip_twice_and_prints_numbers(
    capsys: pytest.CaptureFixture[str],
) -> None:
    many_clips.main(["--clips", "10", "--seconds", "1.5", "--processes", "1", "--preset", "genea"])
    lines = [line.split(": ") for line in capsys.readouterr().out.splitlines()]
    found = {name: float(value) for name, value in lines}
    assert found["clips"] == 10
    assert found["clip_scores"] == 20
    assert found["cold_clips_per_s"] > 0
    assert found["kept_clips_per_s"] > 0
