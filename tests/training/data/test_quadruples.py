"""Fours of windows: two texts, each by two speakers, in one emotion."""

from __future__ import annotations

from dataclasses import replace

from tests.generators.amuse.toy_speech import ROWS, toy_speech
from training.data.quadruples import quadruples
from training.data.windows import Windows


def _windows() -> Windows:
    return Windows(toy_speech(), split="train", frames=ROWS, stride=ROWS)


def test_each_four_has_two_texts_by_two_speakers_in_one_emotion() -> None:
    windows = _windows()
    fours = quadruples(windows, most=100, seed=0)
    assert len(fours) == 2 * 2  # Emotions times windows of a take.
    for row in fours:
        takes = [windows.take_of(int(one)) for one in row]
        texts = [take.name.rsplit("_", 1)[1] for take in takes]
        assert len({take.emotion for take in takes}) == 1
        assert [take.speaker for take in takes] == ["ann", "ann", "bob", "bob"]
        assert texts[0] == texts[2] != texts[1] == texts[3]
        assert len({windows.start_of(int(one)) for one in row}) == 1


def test_of_too_many_some_are_drawn_the_same_each_time() -> None:
    fours = quadruples(_windows(), most=3, seed=7)
    assert len(fours) == 3
    assert (fours == quadruples(_windows(), most=3, seed=7)).all()


def test_there_are_none_where_one_speaker_speaks_all_texts() -> None:
    prepared = toy_speech()
    alone = tuple(take for take in prepared.takes if take.speaker == "ann")
    arrays = {"filterbank": prepared.arrays["filterbank"][: len(alone)]}
    windows = Windows(
        replace(prepared, takes=alone, arrays=arrays), split="train", frames=ROWS, stride=ROWS
    )
    assert quadruples(windows, most=100, seed=0).shape == (0, 4)
