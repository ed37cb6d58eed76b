from __future__ import annotations

import shutil
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import pytest

from motion.errors import InputError
from renderer.look import Look
from studyapp.stimuli.disk_space import require_space
from studyapp.study.media import ClipVideo

CLIP = ClipVideo(segment="s", condition="c", file="videos/c.mp4", duration=10.0, key="k")
DUBBED = CLIP.model_copy(update={"speech": "other", "file": "videos/d.mp4"})
SIDES = {("s", "c")}


@pytest.mark.parametrize(
    ("clips", "sides", "megabytes", "enough"),
    [
        # Frames count once, and only if pairs are composed of them.
        ([CLIP], set(), 5, True),
        ([CLIP], SIDES, 5, False),
        ([CLIP], SIDES, 20, True),
        ([CLIP, DUBBED], SIDES, 20, True),
    ],
)
def test_rendering_needs_space_for_its_files(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    clips: list[ClipVideo],
    sides: set[tuple[str, str]],
    megabytes: int,
    enough: bool,
) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda _: SimpleNamespace(free=megabytes * 10**6))
    with nullcontext() if enough else pytest.raises(InputError, match="may need"):
        require_space(tmp_path, clips, Look(size=720), sides=sides, limit=10**10, kept=0)
