"""Fours of windows, two texts, each by two speakers, in one emotion; and classes of takes."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from motion.errors import InputError
from tests.generators.amuse.toy_speech import ROWS, toy_speech
from training.data.labelled_windows import Classes, macro_f1, quadruples
from training.data.windows import Windows

WINDOWS = 2
"""Windows of each take."""


def _windows(**changes: Any) -> Windows:
    takes = replace(toy_speech(), **changes)
    return Windows(takes, split="train", frames=ROWS, stride=ROWS)


def test_each_quadruple_has_two_texts_by_two_speakers_in_one_emotion() -> None:
    windows = _windows()
    fours = quadruples(windows, limit=100, seed=0)
    assert len(fours) == 2 * WINDOWS  # Each emotion has one four for each window of a take.
    for row in fours:
        takes = [windows.take_of(int(one)) for one in row]
        texts = [take.name.rsplit("_", 1)[1] for take in takes]
        assert len({take.emotion for take in takes}) == 1
        assert [take.speaker for take in takes] == ["ann", "ann", "bob", "bob"]
        assert texts[0] == texts[2] != texts[1] == texts[3]
        assert len({int(one) % WINDOWS for one in row}) == 1
    some = quadruples(windows, limit=3, seed=7)
    assert len(some) == 3
    assert (some == quadruples(windows, limit=3, seed=7)).all()


def test_a_single_speaker_gives_no_quadruples() -> None:
    prepared = toy_speech()
    alone = tuple(take for take in prepared.takes if take.speaker == "ann")
    arrays = {"filterbank": prepared.arrays["filterbank"][: len(alone)]}
    windows = _windows(takes=alone, arrays=arrays)
    assert quadruples(windows, limit=100, seed=0).shape == (0, 4)
    with pytest.raises(InputError, match="no two speakers speak the same two texts"):
        quadruples(windows, limit=100, seed=0, required=True)


def test_classes_are_those_of_the_training_split() -> None:
    strangers = tuple(
        replace(take, speaker="eve") if take.emotion == "anger" and take.speaker == "bob" else take
        for take in toy_speech().takes
    )
    classes = Classes.from_windows(_windows(), ("emotion", "speaker"))
    assert classes.names == {"emotion": ("anger", "happiness"), "speaker": ("ann", "bob")}
    other = _windows(takes=strangers)
    known = classes.labelled_rows(other)
    assert 0 < len(known) < len(other)
    numbers = classes.numbers(other, known)
    for row, emotion, speaker in zip(known, *numbers, strict=True):
        take = other.take_of(int(row))
        assert take.emotion == classes.names["emotion"][emotion]
        assert take.speaker == classes.names["speaker"][speaker]


def test_macro_f1_weights_rare_classes_like_common_ones() -> None:
    predicted, actual = np.array([0, 0, 0, 0]), np.array([0, 0, 0, 1])
    assert macro_f1(predicted, actual) == pytest.approx((6 / 7 + 0) / 2)
