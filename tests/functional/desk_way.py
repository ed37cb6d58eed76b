"""The desk's whole way: from the owner's link to a study that is rehearsed, served and watched.

Tests walk it; `tools.desk_way` takes a picture at each of its stops, for docs/desk-way.md.
"""

import csv
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from playwright.sync_api import Page, expect

from tests.functional.browsing import follow, press
from tests.functional.joining import NAME, join
from tests.functional.taking_part import answer, begin_study, expect_trial, watch
from tests.support.studies.takes import write_speech

STUDY: Final = "first-study"
TITLE: Final = "Which speaker do you prefer?"
SPEECH: Final = {"greeting": "happiness", "story": "neutral", "quarrel": "anger"}
"""The segments of the study, and their emotions."""

TRIALS: Final = 4
"""Each segment once, and a catch trial."""


UNDER_WAY: Final = re.compile(r"\d of \d|^Done")
"""Text on the page of a job once there is something to see."""


@dataclass(frozen=True)
class Stop:
    """Somewhere on the way.

    Attributes
    ----------
    page : Page
        Shows it.
    name : str
        Of its picture.
    kind : {'researchers', 'participants', 'document'}
        Whose page it is; a document is what a job has written.
    """

    page: Page
    name: str
    kind: Literal["researchers", "participants", "document"] = "researchers"


def write_recordings(folder: Path, *, seconds: float) -> list[Path]:
    """Write a recording of each segment of `SPEECH`, and the table that describes them."""
    folder.mkdir()
    table = folder / "segments.csv"
    with table.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(("name", "wav", "start", "end", "speaker", "emotion", "transcript"))
        for name, emotion in SPEECH.items():
            rows.writerow((name, f"{name}.wav", 0, seconds, "Robin", emotion, ""))
    return [table, *(write_speech(folder / f"{name}.wav", seconds) for name in SPEECH)]


def walk_the_desk(
    page: Page, visitor: Page, link: str, recordings: list[Path], *, participants: int, size: int
) -> Iterator[Stop]:
    """Go the whole way, and give each stop while its page is shown.

    Parameters
    ----------
    page, visitor : Page
        The browsers of the researcher and of a participant.
    link : str
        By which the desk's owner joins.
    recordings : list of Path
        Of `write_recordings`.
    participants : int
        For how many the study has places.
    size : int
        Of the videos, in pixels.
    """
    yield from _join(page, link)
    yield from _make(page, participants)
    yield from _set(page, size)
    yield from _bring_in(page, recordings)
    yield from _make_ready(page)
    yield from _try(page)
    yield from _rehearse(page)
    yield from _take_home(page)
    yield from _take_part(visitor, page.locator("main .link").inner_text())
    yield from _watch(page)


def _join(page: Page, link: str) -> Iterator[Stop]:
    page.goto(link)
    yield Stop(page, "join")
    join(page, link)
    expect(page.get_by_text("You do not belong to a study yet.")).to_be_visible()


def _make(page: Page, participants: int) -> Iterator[Stop]:
    follow(page.get_by_role("link", name="Make a study"))
    page.get_by_role("radio", name="pairwise").check()
    yield Stop(page, "protocol")
    press(page, "Next")
    page.get_by_label("Name", exact=True).fill(STUDY)
    page.get_by_label("Participants").fill(str(participants))
    page.get_by_label("Trials").fill(str(len(SPEECH)))
    page.get_by_label("Title").fill(TITLE)
    page.get_by_label("Institution").fill("Institute of Gestures")
    page.get_by_label("Contact").fill("gestures@example.org")
    page.get_by_role("heading", level=1).scroll_into_view_if_needed()
    yield Stop(page, "describe")
    press(page, "Make the study")
    expect(page.get_by_role("heading", level=1)).to_have_text(TITLE)
    yield Stop(page, "made")


def _set(page: Page, size: int) -> Iterator[Stop]:
    follow(page.get_by_role("link", name="Settings"))
    text = page.get_by_role("textbox")
    definition = text.input_value()
    for before, after in (
        (r"^size = 720$", f"size = {size}"),
        (r"^frame_rate = 30$", "frame_rate = 10"),
        (r"^practice = 1$", "practice = 0"),
        (r"(?<=\[catch\]\n)((?:#.*\n)*)trials = 3$", r"\1trials = 1"),
        (r"^sound_check = true$", "sound_check = false"),
    ):
        definition, count = re.subn(before, after, definition, flags=re.MULTILINE)
        assert count == 1, before
    text.fill(definition.replace("avatar =", "avatr ="))
    press(page, "Save")
    line = definition[: definition.index("\navatar =")].count("\n") + 2
    page.get_by_role("link", name=f"line {line}").click()
    selected = "area => area.value.slice(area.selectionStart, area.selectionEnd)"
    assert text.evaluate(selected) == 'avatr = "alex"'
    yield Stop(page, "settings")
    text.fill(definition)
    press(page, "Save")
    expect(page.get_by_role("status")).to_have_text(
        "Saved. See the study's texts as participants see them."
    )
    _back(page)


def _bring_in(page: Page, recordings: list[Path]) -> Iterator[Stop]:
    follow(page.get_by_role("link", name="Bring in"))
    page.get_by_label("Files", exact=True).set_input_files(recordings)
    press(page, "Upload")
    expect(page.get_by_role("row")).to_have_count(1 + len(recordings))
    page.get_by_role("button", name="Bring into the study").scroll_into_view_if_needed()
    yield Stop(page, "bring-in")
    press(page, "Bring into the study")
    _end(page)
    _back(page)
    follow(page.get_by_role("link", name="Texts"))
    instructions = page.get_by_role("heading", name="Instructions")
    instructions.scroll_into_view_if_needed()
    yield Stop(page, "texts")
    _back(page)


def _begin(page: Page, title: str) -> None:
    """Begin a job from the study's page."""
    row = page.get_by_role("row").filter(has=page.get_by_role("link", name=title, exact=True))
    follow(row.get_by_role("button"))
    expect(page.get_by_role("heading", level=1)).to_have_text(title)


def _end(page: Page) -> None:
    """Wait until the job of this page has succeeded."""
    expect(page.get_by_role("status")).to_contain_text("Done")


def _run(page: Page, title: str) -> None:
    _begin(page, title)
    _end(page)


def _back(page: Page) -> None:
    """Go back to the study's page."""
    follow(page.get_by_role("link", name=f"Back to {STUDY}"))


def _make_ready(page: Page) -> Iterator[Stop]:
    _run(page, "Generate")
    _back(page)
    _begin(page, "Render")
    expect(page.locator("#live").get_by_text(UNDER_WAY).first).to_be_visible()
    yield Stop(page, "render")
    _end(page)
    _back(page)
    _run(page, "Check")
    yield Stop(page, "check")
    _back(page)
    _run(page, "Plan")
    yield Stop(page, "plan")
    _back(page)
    follow(page.get_by_role("link", name="All segments and conditions"))
    yield Stop(page, "material")
    _back(page)


def _try(page: Page) -> Iterator[Stop]:
    study = page.url
    expect(page.get_by_text("ready for participants")).to_be_visible()
    yield Stop(page, "ready")
    press(page, "Preview")
    follow(page.get_by_role("link", name="1", exact=True))
    expect(page.locator("#play")).to_be_visible()
    yield Stop(page, "preview", "participants")
    page.goto(study)
    press(page, "Take part as a test")
    expect(page.get_by_text("This is a test participation")).to_be_visible()
    yield Stop(page, "test", "participants")
    page.goto(study)


def _rehearse(page: Page) -> Iterator[Stop]:
    _run(page, "Rehearse")
    follow(page.get_by_role("link", name="What it found"))
    yield Stop(page, "rehearsal", "document")
    page.go_back()
    _back(page)


def _take_home(page: Page) -> Iterator[Stop]:
    _run(page, "Report")
    yield Stop(page, "take-home")
    follow(page.get_by_role("link", name="Open the report"))
    yield Stop(page, "report", "document")
    page.go_back()
    _back(page)


def _take_part(visitor: Page, address: str) -> Iterator[Stop]:
    begin_study(visitor, address)
    for number in range(1, TRIALS + 1):
        expect_trial(visitor, number)
        watch(visitor)
        answer(visitor)
        if number == 1:
            yield Stop(visitor, "participant", "participants")
        visitor.locator("#next").click()
    expect(visitor.locator("#completion-code")).to_be_visible()
    yield Stop(visitor, "code", "participants")


def _watch(page: Page) -> Iterator[Stop]:
    press(page, "Watch")
    expect(page.locator(".truth")).to_contain_text("1 of ")
    expect(page.get_by_role("navigation")).to_contain_text(NAME)
    yield Stop(page, "watch")
    follow(page.get_by_role("link", name="Study sessions"))
    follow(page.get_by_role("row").last.get_by_role("link"))
    expect(page.locator(".events")).to_contain_text("Trial 1 was shown")
    page.locator(".events li").last.scroll_into_view_if_needed()
    yield Stop(page, "session")
