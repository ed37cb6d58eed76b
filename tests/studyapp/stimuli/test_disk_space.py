from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from motion.errors import InputError
from renderer.look import Look
from studyapp.stimuli.disk_space import check_room
from studyapp.study.media import ClipVideo


class Usage(NamedTuple):
    total: int
    used: int
    free: int


CLIP = ClipVideo(segment="s", condition="c", file="videos/c.mp4", duration=10.0, key="k")
DUBBED = CLIP.model_copy(update={"speech": "other", "file": "videos/d.mp4"})
SIDES = {("s", "c")}


@pytest.fixture
def needed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., int]:
    """Return a function that finds the least free bytes with which rendering begins."""

    def enough(free: int, clips: list[ClipVideo], sides: set[tuple[str, str]]) -> bool:
        monkeypatch.setattr(shutil, "disk_usage", lambda folder: Usage(10**12, 0, free))
        try:
            check_room(tmp_path, clips, Look(size=720), sides=sides, limit=10**10, kept=0)
        except InputError:
            return False
        return True

    def find(clips: list[ClipVideo], sides: set[tuple[str, str]]) -> int:
        low, high = 0, 10**10
        while low < high:
            middle = (low + high) // 2
            low, high = (low, middle) if enough(middle, clips, sides) else (middle + 1, high)
        return low

    return find


def test_frames_count_only_where_pairs_are_composed_from_them(
    needed: Callable[..., int],
) -> None:
    alone, beside = needed([CLIP], set()), needed([CLIP], SIDES)

    assert 0 < alone < beside / 3


def test_another_speech_needs_no_frames_of_its_own(needed: Callable[..., int]) -> None:
    both = needed([CLIP, DUBBED], SIDES)

    assert both == pytest.approx(needed([CLIP], SIDES) + needed([DUBBED], SIDES), abs=2)
    assert needed([DUBBED], SIDES) == needed([CLIP], set())
