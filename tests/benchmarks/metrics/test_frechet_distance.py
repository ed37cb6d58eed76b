from __future__ import annotations

from benchmarks.metrics import frechet_distance


def test_the_benchmark_prints_a_number_behind_every_name(monkeypatch, capsys):
    monkeypatch.setattr(frechet_distance, "SHAPES", ((6, 8), (30, 4)))
    frechet_distance.main()
    lines = [line.split(": ") for line in capsys.readouterr().out.splitlines()]
    assert len(lines) == 10
    assert all(float(value) > -1 for _, value in lines)
    assert lines[2][0] == "frechet_n6_d8_times_faster"
