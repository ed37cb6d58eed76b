import re
from collections.abc import Sequence
from html import unescape
from pathlib import Path

import numpy as np
import pytest

from renderer.figures.sheet import Glance, draw_cell, glance_at, sheet_page
from renderer.look import Look
from tests.renderer.figures.small_videos import CONDITIONS, sheet_of, write_block_video


def test_the_page_shows_every_stimulus_or_a_gap_and_needs_only_the_videos(tmp_path: Path) -> None:
    video = write_block_video(tmp_path / "video.mkv", [40, 44, 48] * 10)
    page = sheet_page(sheet_of(CONDITIONS[:2], draw_cell(glance_at(video))))
    assert len(re.findall("<img[ >]", page)) == page.count('class="missing"') == 2
    text = unescape(re.sub("<[^>]+>", "", page))
    for words in ("Who & why", "two", "anger, robin, 2.0 s", "<b>Die Straße", "reference"):
        assert words in text
    assert text.count("jumps") == 2
    for address in re.findall(r'(?:src|href)="([^"]+)"', page):
        assert address.startswith(("data:image/webp;base64,", "../../videos/clips/"))


SWAYING: list[int | None] = [44 + round(12 * np.sin(k / 4)) for k in range(90)]


def glance(tmp_path: Path, places: Sequence[int | None]) -> Glance:
    return glance_at(write_block_video(tmp_path / "video.mkv", places))


@pytest.mark.parametrize(
    ("places", "remarks"),
    [
        ([*SWAYING], ()),
        ([44] * 60, ("never moves",)),
        ([*SWAYING[:30], *SWAYING[30:31] * 45, *SWAYING[30:60]], ("still from 1.0 to 2.5 s",)),
        ([*SWAYING[:30], *SWAYING[30:31] * 20, *SWAYING[30:60]], ()),
        (
            [*SWAYING[:40], *[69 + round(12 * np.sin(k / 4)) for k in range(40, 80)]],
            ("jumps at 1.3 s",),
        ),
        ([20 + 45 * (k % 2) for k in range(60)], ("jerks throughout",)),
        ([None, *SWAYING[:3]] * 15, ("jerks throughout", "nobody in the picture 25% of the time")),
        ([44 + k for k in range(60)], ("out of the picture 28% of the time",)),
    ],
    ids=["ordinary", "never moves", "freezes", "rests", "jumps", "jerks", "missing", "leaving"],
)
def test_problems_of_a_motion_are_listed_once_with_their_times(
    tmp_path: Path, places: list[int | None], remarks: tuple[str, ...]
) -> None:
    assert glance(tmp_path, places).remarks == remarks


def test_a_figure_is_found_on_any_background(tmp_path: Path) -> None:
    black = Look(background=(0, 0, 0))
    usual = glance(tmp_path, [40, 44, 48] * 10)
    dark = glance_at(write_block_video(tmp_path / "dark.mkv", [40, 44, 48] * 10, (0, 0, 0)), black)
    assert 0.1 < usual.presence.mean() < 0.5
    np.testing.assert_allclose(dark.presence, usual.presence, atol=0.05)


def test_a_figure_may_be_cut_off_at_any_edge(tmp_path: Path) -> None:
    video = write_block_video(tmp_path / "video.mkv", [-20, -18, -16] * 10)
    message = "out of the picture 100% of the time"
    assert message in glance_at(video, Look(framing="full_body")).remarks
    assert message not in glance_at(video, Look(framing="face")).remarks
