from dataclasses import astuple
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion.errors import InputError
from motion.segment import (
    CUT_TOLERANCE,
    EMOTIONS,
    Segment,
    excerpt_bounds,
    read_segments,
    write_segments,
)


@given(
    speech_rate=st.sampled_from([16000, 22050, 48000]),
    frame_rate=st.sampled_from([15.0, 25.0, 29.97, 30.0]),
    start=st.floats(0, 50),
    length=st.floats(0.1, 10),
)
def test_speech_and_motion_of_an_excerpt_have_equal_length(
    speech_rate: int, frame_rate: float, start: float, length: float
) -> None:
    durations = []
    for rate in (speech_rate, frame_rate):
        first, count = excerpt_bounds(start, start + length, rate=rate, length=round(60 * rate))
        assert abs(first / rate - start) <= 0.5 / rate + 1e-9
        durations.append(count / rate)
    assert abs(durations[0] - durations[1]) <= 0.5 / frame_rate + 0.5 / speech_rate + 1e-9


@pytest.mark.parametrize(
    ("start", "end"),
    [(-0.1, 0.5), (0.5, 0.5), (0.6, 0.5), (0.5, 1.2), (1, 1.05), (0.5, 0.501), (0, float("nan"))],
)
def test_an_excerpt_may_end_slightly_late_but_not_lie_outside_or_be_empty(
    start: float, end: float
) -> None:
    assert excerpt_bounds(0, 1 + CUT_TOLERANCE, rate=100, length=100) == (0, 110)
    with pytest.raises(InputError, match=r"excerpt from .* in 1\.00 s"):
        excerpt_bounds(start, end, rate=100, length=100)


HEADER = "name,wav,start,end,speaker,emotion,transcript\n"


@pytest.fixture
def speech(tmp_path: Path) -> Path:
    (tmp_path / "a.wav").write_bytes(b"sound")
    return tmp_path


segments = st.builds(
    Segment,
    name=st.from_regex(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,20}", fullmatch=True),
    wav=st.just("a.wav"),
    start=st.floats(0, 100),
    end=st.floats(101, 200),
    speaker=st.from_regex(r"[a-z]{1,8}", fullmatch=True),
    emotion=st.sampled_from(EMOTIONS),
    transcript=st.text(st.characters(exclude_categories=["Cs", "Cc"]), max_size=40)
    | st.sampled_from(['He said: "no, never"', "two\nlines", "ünïcödé"]),
)


@given(st.lists(segments, min_size=1, max_size=5, unique_by=lambda segment: segment.name))
def test_segments_survive_a_round_trip(
    tmp_path_factory: pytest.TempPathFactory, written: list[Segment]
) -> None:
    speech = tmp_path_factory.mktemp("speech")
    (speech / "a.wav").write_bytes(b"sound")
    write_segments(speech, written)
    assert read_segments(speech) == tuple(written)


def test_a_spreadsheet_export_is_read(speech: Path) -> None:
    text = HEADER.replace("\n", "\r\n") + "s1 , a.wav, 0, 4.5,scott,fear,Hello\r\n,,,,,,\r\n\r\n"
    (speech / "segments.csv").write_bytes(b"\xef\xbb\xbf" + text.encode())
    (segment,) = read_segments(speech)
    assert astuple(segment) == ("s1", "a.wav", 0, 4.5, "scott", "fear", "Hello")


@pytest.mark.parametrize(
    ("row", "complaint"),
    [
        ("s1,a.wav,0,5,x,neutral,", "segment 's1' is already on line 2"),
        ("s2,gone.wav,0,5,x,neutral,", "no file 'gone.wav'"),
        ("s2,a.wav,zero,5,x,neutral,", "start 'zero' is not a number"),
        ("s2,a.wav,0,nan,x,neutral,", "make no excerpt"),
        ("s2,a.wav,5,1,x,neutral,", "make no excerpt"),
        ("s2,a.wav,0,5,x,bored,", "unknown emotion 'bored'"),
        ("s/2,a.wav,0,5,x,neutral,", "not a usable segment name"),
        ("s2,../a.wav,0,5,x,neutral,", "plain file name"),
        ("s2,a.wav,0,5,x,neutral,one, two", "not have 7 cells"),
    ],
)
def test_an_error_names_the_file_and_line_of_a_bad_row(
    speech: Path, row: str, complaint: str
) -> None:
    first = "s1,a.wav,0,5,x,neutral,hello\n"
    (speech / "segments.csv").write_text(f"{HEADER}{first}{row}\n", encoding="utf-8")
    with pytest.raises(InputError, match=complaint) as caught:
        read_segments(speech)
    assert caught.value.where == f"{speech / 'segments.csv'}, line 3"
    assert caught.value.remedy


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        (None, "the table of its segments is missing"),
        ("", f"exactly the columns {HEADER.strip()}"),
        (HEADER.replace(",", ";"), f"exactly the columns {HEADER.strip()}"),
        (HEADER.replace("wav", "sound"), f"exactly the columns {HEADER.strip()}"),
        (HEADER, "holds no segment"),
        (f'{HEADER}s1,a.wav,0,5,x,neutral,"{"x" * 200_000}"\n', "the table is not CSV"),
        (f'{HEADER}s1,a.wav,0,5,x,fear,"Hi\ns2,a.wav,0,5,x,fear,"Hi"\n', "line 3: .* not CSV"),
        (f"{HEADER}s1,a.wav,0,5,jörg,neutral,", "not UTF-8"),
    ],
    ids=["missing", "blank", "semicolons", "column", "no row", "long", "open quote", "encoding"],
)
def test_an_unreadable_table_is_refused(speech: Path, content: str | None, complaint: str) -> None:
    if content is not None:
        (speech / "segments.csv").write_text(content, encoding="latin-1")
    with pytest.raises(InputError, match=rf"segments\.csv.*{complaint}"):
        read_segments(speech)
