from __future__ import annotations

from itertools import combinations

import pytest

from analysis.report.figures.dot_figure import Dot, dot_pictures, round_ticks, spread
from analysis.report.figures.panels import (
    NARROW,
    WIDE,
    Format,
    RowName,
    Scale,
    plans,
    row_height,
)
from tests.analysis.report.headline.reading import drawn

LONG = "a condition with a name of so many words that no figure has room for all of them"


@pytest.mark.parametrize("room", [WIDE, NARROW], ids=["wide", "narrow"])
@pytest.mark.parametrize("questions", [1, 2, 3, 8])
@pytest.mark.parametrize("rows", [1, 2, 12])
@pytest.mark.parametrize("name", ["ours", LONG])
def test_panels_never_overlap_and_sheets_fit_a_page(
    room: Format, questions: int, rows: int, name: str
) -> None:
    titles = [f"Question {k} {name}" for k in range(questions)]
    names = [RowName(name=f"{k} {name}", below="n = 23") for k in range(rows)]
    sheets = plans(titles, names, foot=0.4, room=room)
    assert [place.number for sheet in sheets for place in sheet.places] == list(range(questions))
    for sheet in sheets:
        assert sheet.height <= room.tallest
        for place in sheet.places:
            assert place.left >= room.labels
            assert place.left + place.width <= room.width + 1e-9
            assert place.top - place.head >= -1e-9
            assert place.top + place.height <= sheet.height - 0.4
        for one, other in combinations(sheet.places, 2):
            beside = one.left + one.width < other.left or other.left + other.width < one.left
            below = one.top + one.height < other.top - other.head
            assert beside or below


def test_rows_are_as_high_as_their_longest_name_needs() -> None:
    short, long = RowName(name="ours"), RowName(name=LONG, below="n = 23")
    assert long.text(WIDE).count("\n") == 2
    assert "…" in long.text(WIDE)
    assert row_height([short, long]) > row_height([short])


@pytest.mark.parametrize(
    ("limits", "ticks"),
    [
        ((0.0, 1.0), {0.0: "0.0", 0.2: "0.2", 0.4: "0.4", 0.6: "0.6", 0.8: "0.8", 1.0: "1.0"}),
        ((-1.3, 2.2), {-1.0: "−1", 0.0: "0", 1.0: "1", 2.0: "2"}),
        ((-130, 20), {-100.0: "−100", -50.0: "−50", 0.0: "0"}),
        ((3.01, 3.02), {k / 1000: f"{k / 1000:.3f}" for k in range(3010, 3021, 2)}),
    ],
)
def test_ticks_are_round_numbers(limits: tuple[float, float], ticks: dict[float, str]) -> None:
    assert round_ticks(limits) == ticks


def test_an_axis_holds_every_interval() -> None:
    low, high = spread([Dot(estimate=1.0, low=-2.0, high=4.0), Dot(estimate=float("nan"))])
    assert low < -2.0
    assert high > 4.0
    assert spread([], around=0.0) == (-0.5, 0.5)


def test_marks_tell_what_is_descriptive_and_what_is_the_whole() -> None:
    dots = [
        Dot(estimate=0.4, low=0.1, high=0.7, words=".40", hint="anger: .40", descriptive=True),
        Dot(estimate=0.5, low=0.3, high=0.7, words=".50", hint="over all: .50", whole=True),
    ]
    (picture,) = dot_pictures(
        {"emotion": dots},
        [RowName(name="anger"), RowName(name="all emotions")],
        Scale(limits=(0, 1), ticks={0: "0", 1: "1"}, label="win share"),
        name="forest",
        title="A forest",
        told={"emotion": "Emotion. anger: .40; over all: .50."},
        caption="",
        data="",
        mark="Rehearsal",
    )
    svg = drawn(picture)
    hollow, full = (svg.find(id=f"forest-dot0-{row}") for row in (0, 1))
    assert "var(--paper" in str(hollow)
    assert "var(--paper" not in str(full)
    assert {"anger", "all emotions", "Rehearsal", "win share"} <= {
        t.get_text() for t in svg("text")
    }


def test_a_narrow_screen_gets_the_same_panels_one_below_the_other() -> None:
    dots = [Dot(estimate=0.4, low=0.1, high=0.7, words=".40", hint="ours: .40")]
    (picture,) = dot_pictures(
        {"emotion": dots, "rhythm": dots},
        [RowName(name="ours")],
        Scale(limits=(0, 1), ticks={0: "0", 1: "1"}, label="win share"),
        name="forest",
        title="A forest",
        told={"emotion": "Emotion.", "rhythm": "Rhythm."},
        caption="",
        data="",
        mark="",
    )
    wide, narrow = (drawn(picture, place) for place in (0, 1))
    assert (wide["class"], narrow["class"]) == (["wide"], ["narrow"])
    sizes = [list(map(float, str(svg["viewbox"]).split()))[2:] for svg in (wide, narrow)]
    assert sizes[0][0] > 1.5 * sizes[1][0]
    assert sizes[0][1] < sizes[1][1]
    said = [sorted({text.get_text() for text in svg("text")}) for svg in (wide, narrow)]
    assert said[0] == said[1]
    ids = [{tag["id"] for tag in svg(id=True)} for svg in (wide, narrow)]
    assert not ids[0] & ids[1]
