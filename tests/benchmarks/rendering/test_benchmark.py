from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
NAMES = [
    "clip_fps", "pair_fps", "plain_loop_fps", "patched_loop_fps", "x264_fps",
    "pair_over_plain_loop", "compose_over_x264", "peak_mb",
]  # fmt: skip

_BRIEFLY = """
from benchmarks.rendering import __main__ as benchmark
from renderer.look import Look
benchmark.SECONDS, benchmark.ROUNDS, benchmark.PEER_FRAMES = 0.2, 1, 2
benchmark._CLIPS_PER_PROCESS, benchmark.os.cpu_count = 2, lambda: 1
benchmark.Look = lambda: Look(size=96)
if __name__ == "__main__":
    benchmark.main()
"""


@pytest.mark.slow
def test_the_benchmark_prints_its_values_one_per_line(tmp_path: Path) -> None:
    (tmp_path / "brief.py").write_text(_BRIEFLY)
    done = subprocess.run(
        [sys.executable, str(tmp_path / "brief.py")],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    last = done.stdout.splitlines()[-len(NAMES) :]
    assert [line.split(": ")[0] for line in last] == NAMES
    assert all(re.fullmatch(r"\w+: \d+\.\d+", line) for line in last)
