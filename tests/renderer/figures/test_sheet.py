from __future__ import annotations

from html.parser import HTMLParser

import pytest

from motion.segment import Segment
from renderer.figures.glance import glance_at
from renderer.figures.sheet import (
    ROWS_ON_PAGE,
    Cell,
    Sheet,
    SheetCell,
    draw_cell,
    sheet_page,
    sheet_pictures,
)
from tests.renderer.figures.small_videos import write_block_video


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Cell:
    video = tmp_path_factory.mktemp("sheet") / "video.mkv"
    return draw_cell(glance_at(write_block_video(video, [40, 44, 48] * 10)))


def sheet_of(cell: Cell, count: int) -> Sheet:
    segments = tuple(
        Segment(
            name=f"segment-{k:02}", wav="a.wav", start=0, end=2.5, speaker="robin",
            emotion="anger", transcript='<b>"never"</b>',
        )
        for k in range(count)
    )  # fmt: skip
    entries = {}
    for segment in segments:
        address = f"../../videos/clips/ours/{segment.name}.mp4"
        entries[segment.name, "ours"] = SheetCell(cell=cell, remark="jumps", video=address)
        entries[segment.name, "theirs"] = SheetCell(cell=None, remark="no video", video="")
    return Sheet(
        title="Who & why",
        facts="2 conditions",
        conditions=("ours", "theirs"),
        roles={"ours": "reference"},
        segments=segments,
        cells=entries,
    )


class Reader(HTMLParser):
    """Notes every address and counts what there is."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.addresses: list[str] = []
        self.counts: dict[str, int] = {}
        self.text = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.counts[tag] = self.counts.get(tag, 0) + 1
        for name, value in attrs:
            if name in ("src", "href") and value:
                self.addresses.append(value)

    def handle_data(self, data: str) -> None:
        self.text += data


def test_the_page_shows_every_stimulus_and_says_what_is_missing(cell: Cell) -> None:
    page = Reader(sheet_page(sheet_of(cell, 3)))
    assert page.counts["img"] == 3
    assert page.counts["td"] == 6
    for wanted in ("Who & why", "segment-02", "anger, robin, 2.5 s", '<b>"never"</b>', "reference"):
        assert wanted in page.text
    assert page.text.count("no video") == page.text.count("jumps") == 3


def test_the_page_needs_no_other_file_but_the_videos(cell: Cell) -> None:
    for address in Reader(sheet_page(sheet_of(cell, 3))).addresses:
        assert address.startswith(("data:image/webp;base64,", "../../videos/clips/"))


def test_many_segments_fill_several_pictures_of_bounded_size(cell: Cell) -> None:
    pages = list(sheet_pictures(sheet_of(cell, 2 * ROWS_ON_PAGE + 1)))
    assert len(pages) == 3
    assert pages[0].size == pages[1].size
    assert pages[2].height < pages[0].height < 4000


def test_a_clip_without_picture_has_an_empty_frame_there(cell: Cell) -> None:
    (page,) = sheet_pictures(sheet_of(cell, 1))
    colours = {colour for _, colour in page.getcolors(1 << 20) or []}
    assert (0xB0, 0x45, 0x00) in colours
