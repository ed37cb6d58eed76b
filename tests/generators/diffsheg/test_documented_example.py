"""What docs/diffsheg.md shows runs as it stands there."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from generators.interface import SpeechSegment
from motion.audio import write_wav
from tests.generators.diffsheg.small_network import written_network

PAGE = Path(__file__).parents[3] / "docs" / "diffsheg.md"


def test_the_example_of_streaming_moves_while_somebody_speaks(
    tmp_path: Path,
    speak: Callable[..., SpeechSegment],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (example,) = re.findall(r"```python\n([^`]*stream_clips[^`]*)```", PAGE.read_text("utf-8"))
    written_network(tmp_path / "tiny.safetensors")
    write_wav(tmp_path / "hello.wav", speak("hello", 5.0).audio)
    monkeypatch.chdir(tmp_path)
    exec(compile(example, str(PAGE), "exec"), {})  # noqa: S102 - it is our own page
    assert capsys.readouterr().out.splitlines() == [
        "1.9 s: body (28, 55, 3), face (28, 52)",
        "1.9 s: body (28, 55, 3), face (28, 52)",
        "1.3 s: body (19, 55, 3), face (19, 52)",
    ]
