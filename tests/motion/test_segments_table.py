from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion.errors import InputError
from motion.segment import EMOTIONS, Segment
from motion.segments_table import read_segments, write_segments

HEADER = "name,wav,start,end,speaker,emotion,transcript\n"


@pytest.fixture
def speech(tmp_path: Path) -> Path:
    (tmp_path / "a.wav").write_bytes(b"sound")
    return tmp_path


def table(speech: Path, rows: str, header: str = HEADER) -> Path:
    (speech / "segments.csv").write_text(header + rows, encoding="utf-8")
    return speech


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
def test_segments_written_are_read_back(
    tmp_path_factory: pytest.TempPathFactory, written: list[Segment]
) -> None:
    speech = tmp_path_factory.mktemp("speech")
    (speech / "a.wav").write_bytes(b"sound")
    write_segments(speech, written)
    assert read_segments(speech) == tuple(written)


def test_spreadsheet_export_is_read(speech: Path) -> None:
    text = HEADER.replace("\n", "\r\n") + "s1 , a.wav, 0, 4.5,scott,fear,Hello\r\n,,,,,,\r\n\r\n"
    (speech / "segments.csv").write_bytes(b"\xef\xbb\xbf" + text.encode())
    (segment,) = read_segments(speech)
    assert segment == Segment(
        name="s1",
        wav="a.wav",
        start=0,
        end=4.5,
        speaker="scott",
        emotion="fear",
        transcript="Hello",
    )


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
        ("s2,a.wav,0,5,x,neutral,one, two", "8 cells for 7 columns"),
    ],
)
def test_bad_row_is_named_by_file_and_line(speech: Path, row: str, complaint: str) -> None:
    table(speech, "s1,a.wav,0,5,x,neutral,hello\n" + row + "\n")
    with pytest.raises(InputError, match=complaint) as caught:
        read_segments(speech)
    assert caught.value.where == f"{speech / 'segments.csv'}, line 3"
    assert caught.value.remedy


@pytest.mark.parametrize(
    "header",
    ["name,wav,start,end\n", HEADER.replace(",", ";"), HEADER.replace("wav", "sound"), ""],
)
def test_wrong_columns_are_refused_with_the_right_ones(speech: Path, header: str) -> None:
    table(speech, "", header)
    with pytest.raises(InputError, match=re.escape(HEADER.strip())):
        read_segments(speech)


def test_missing_table_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"segments\.csv: the table of speech segments is missing"):
        read_segments(tmp_path)


def test_table_without_rows_is_refused(speech: Path) -> None:
    with pytest.raises(InputError, match="holds no segment"):
        read_segments(table(speech, ""))


def test_table_with_a_cell_beyond_measure_is_refused(speech: Path) -> None:
    with pytest.raises(InputError, match=r"segments\.csv: the table is not CSV"):
        read_segments(table(speech, f's1,a.wav,0,5,x,neutral,"{"x" * 200_000}"\n'))


def test_table_in_another_encoding_is_refused(speech: Path) -> None:
    (speech / "segments.csv").write_bytes(
        HEADER.encode() + "s1,a.wav,0,5,jörg,neutral,".encode("latin-1")
    )
    with pytest.raises(InputError, match="not UTF-8"):
        read_segments(speech)
