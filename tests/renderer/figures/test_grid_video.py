from collections.abc import Callable, Iterator
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from motion.clip import MotionClip
from renderer.clip_video import Stage, still
from renderer.encoder import SOUND_RATE
from renderer.figures.grid_video import GridLayout, write_grid
from renderer.framing import Camera
from renderer.look import BACKGROUND, Look, default_body
from tests.support.encoded import pictures_of, sound_of
from tests.support.sounds import tone

Clips = tuple[MotionClip, MotionClip]
Write = Callable[..., Path]
SIZE = 96
SECONDS = 0.4


@pytest.fixture(scope="module")
def stage(camera: Camera) -> Iterator[Stage]:
    with Stage(default_body(), camera, Look(size=SIZE)) as stage:
        yield stage


@pytest.fixture(scope="module")
def clips(clip: MotionClip) -> Clips:
    """Return two clips that differ: the motion forwards and backwards."""
    count = round(SECONDS * 30)
    return clip.frames(slice(0, count)), clip.frames(np.arange(len(clip))[: -count - 1 : -1])


@pytest.fixture(scope="module")
def write(stage: Stage) -> Write:
    def write(clips: tuple[MotionClip, ...], video: Path, **changes: object) -> Path:
        captioned = {f"condition {k}": clip for k, clip in enumerate(clips)}
        given = {"text": "we got the house", "video": video}
        hum = tone(SECONDS, 220, SOUND_RATE, 0.3)
        write_grid(stage, captioned, hum, **(given | changes))  # type: ignore[arg-type]
        return video

    return write


@pytest.fixture(scope="module")
def grid(write: Write, clips: Clips, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(clips, tmp_path_factory.mktemp("grid") / "grid.mp4")


@pytest.mark.parametrize("count", [1, 2, 3, 5, 8, 9])
def test_panels_stay_inside_the_frame_without_overlap(count: int) -> None:
    layout = GridLayout(count=count, size=64)
    width, height = layout.frame
    assert width % 2 == height % 2 == 0
    places = [layout.position(number) for number in range(count)]
    for left, top in places:
        assert left % 2 == top % 2 == 0
        assert left >= 0
        assert left + 64 <= width
        assert top + 64 + layout.caption_height <= height
    for one, two in combinations(places, 2):
        is_beside = abs(one[0] - two[0]) >= 64
        assert is_beside or abs(one[1] - two[1]) >= 64 + layout.caption_height


def test_each_clip_is_in_its_place_in_every_frame_with_the_speech(
    grid: Path, stage: Stage, clips: Clips
) -> None:
    assert sound_of(grid)[4800:-4800].std() > 0.02
    frames = pictures_of(grid).astype(int)
    assert len(frames) == round(SECONDS * 30)
    layout = GridLayout(count=2, size=SIZE, text="words")
    for number in (0, 7, 11):
        for place, clip in enumerate(clips):
            left, top = layout.position(place)
            expected = np.asarray(still(stage, clip, number / 30)).astype(int)
            part = frames[number, top : top + SIZE, left : left + SIZE]
            assert np.abs(part - expected).mean() < 2.5


def test_names_words_and_time_stand_below(grid: Path) -> None:
    layout = GridLayout(count=2, size=SIZE, text="words")
    first, last = pictures_of(grid)[[0, -1]].astype(int)
    ink = np.abs(first - BACKGROUND).max(axis=-1) > 60
    captions = ink[SIZE : SIZE + layout.caption_height]
    assert captions[:, :SIZE].any()
    assert captions[:, SIZE:].any()
    footer = np.s_[-layout.footer_height :]
    assert ink[footer].any()
    assert np.abs(first[footer] - last[footer]).max() > 40  # the clock goes on
