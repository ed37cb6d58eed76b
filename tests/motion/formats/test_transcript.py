"""Transcripts are read in all formats, and refused if they belong to other speech."""

from pathlib import Path

import numpy as np
import pytest

from motion.audio import Audio
from motion.errors import InputError
from motion.formats.transcript import Word, is_word_table, read_transcript, spread_words

SAID = ((0, 0.5, "Hello,"), (0.5, 1.0, ""), (1.0, 2.0, "world"))
GRID = 'File type = "ooTextFile"\nObject class = "TextGrid"\n\nxmin = 0\nxmax = 2\n'
GRID += 'tiers? <exists>\nsize = 1\nitem []:\nitem [1]:\nclass = "IntervalTier"\n'
GRID += 'name = "words"\nxmin = 0\nxmax = 2\nintervals: size = 3\n' + "".join(
    f'intervals [{number}]:\nxmin = {start}\nxmax = {end}\ntext = "{text}"\n'
    for number, (start, end, text) in enumerate(SAID, 1)
)


@pytest.fixture
def audio() -> Audio:
    """Two seconds, of which the second half is loud."""
    samples = np.zeros(32000, np.float32)
    samples[16000:] = 0.5 * np.sin(np.arange(16000) / 10)
    return Audio(samples, 16000)


@pytest.mark.parametrize(
    ("name", "text"), [("a.TextGrid", GRID), ("a.csv", "word,start,end\nHello,0,0.5\nworld,1,2\n")]
)
def test_aligned_words_keep_their_times(tmp_path: Path, audio: Audio, name: str, text: str) -> None:
    (tmp_path / name).write_text(text)
    result = read_transcript(tmp_path / name, audio)
    assert result == (Word("hello", 0.0, 0.5), Word("world", 1.0, 2.0))


def test_words_of_plain_text_are_spread_over_the_speech(tmp_path: Path, audio: Audio) -> None:
    (tmp_path / "a.lab").write_text("One, three!\n")
    one, three = read_transcript(tmp_path / "a.lab", audio)
    assert (one.text, three.text) == ("one", "three")
    assert one.start == pytest.approx(1.0, abs=0.02)
    assert one.end == three.start == pytest.approx(1.4, abs=0.02)
    assert three.end == pytest.approx(2.0, abs=0.02)
    assert spread_words("", audio) == ()


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.csv", "word,start,end\nlate,5,6\n", "other speech: it has 1 words until 6.0 s"),
        ("a.lab", "word " * 60, "belongs to other speech: it has 60 words"),
        ("a.csv", "word,from,to\na,0,1\n", "has no words"),
        ("a.csv", "word,start,end\na,x,1\n", r"line 2.*has no time"),
        ("a.csv", "word,start,end\na,2,1\n", "starts at 2 s and ends at 1 s"),
        ("a.TextGrid", "nothing", "not a TextGrid"),
        ("a.lab", "caf\xe9", "text in UTF-8"),
    ],
)
def test_other_transcripts_are_refused(
    tmp_path: Path, audio: Audio, name: str, text: str, message: str
) -> None:
    (tmp_path / name).write_text(text, "latin-1")
    with pytest.raises(InputError, match=message):
        read_transcript(tmp_path / name, audio)


def test_other_tables_are_not_mistaken_for_word_tables(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("0,1,neutral\n")
    (tmp_path / "b.csv").write_text("start,end,word\n")
    assert not is_word_table(tmp_path / "a.csv")
    assert is_word_table(tmp_path / "b.csv")
