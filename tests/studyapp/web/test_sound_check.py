"""The sound check's page: only listening tells the digits."""

from __future__ import annotations

import io
import wave
from typing import get_args

import numpy as np
import pyloudnorm
import pytest
from flask import Flask
from numpy.typing import NDArray
from sqlalchemy import select

from studyapp.database.tables import StudySession
from studyapp.study.settings.presentation import Language
from studyapp.web.participants.sound_check import spoken
from studyapp.web.running import running
from tests.studyapp.taking_part_steps import SetClock
from tests.studyapp.web.conftest import Serve
from tests.studyapp.web.visitor import Visitor

LANGUAGES = get_args(Language)


def heard(sound: bytes) -> tuple[NDArray[np.float64], int]:
    with wave.open(io.BytesIO(sound)) as file:
        samples = np.frombuffer(file.readframes(file.getnframes()), np.int16) / 32768
        return samples, file.getframerate()


@pytest.mark.parametrize("language", LANGUAGES)
def test_digits_cannot_be_told_by_size_and_have_the_loudness_of_videos(language: Language) -> None:
    sounds = [spoken(language, digits) for digits in ("012", "345", "678", "999")]

    assert len({len(sound) for sound in sounds}) == 1
    assert len(set(sounds)) == 4
    for sound in sounds:
        samples, rate = heard(sound)
        assert pyloudnorm.Meter(rate).integrated_loudness(samples) == pytest.approx(-23, abs=3)
        assert np.abs(samples).max() < 0.9


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_digit_sounds_different_and_is_heard_where_it_stands(language: Language) -> None:
    alone = [heard(spoken(language, str(digit)))[0] for digit in range(10)]
    for one in range(10):
        for other in range(one):
            assert np.abs(alone[one] - alone[other]).max() > 0.1

    both, _ = heard(spoken(language, "37"))
    first = alone[3]
    assert np.array_equal(both[: len(first)], first)


@pytest.fixture
def listening(serve: Serve) -> Flask:
    return serve(("[page]\n", "[page]\nsound_check = true\n"))


@pytest.fixture
def visitor(listening: Flask) -> Visitor:
    """Return a participant at the sound check."""
    return Visitor(listening, SetClock()).enrol()


def test_page_and_headers_are_the_same_whatever_the_digits(
    listening: Flask, visitor: Visitor
) -> None:
    source = visitor.page().value("audio", "src")
    told = []
    for drawn in ("123", "987"):
        with listening.app_context(), running().database.writing() as session:
            session.scalars(select(StudySession)).one().sound_digits = drawn
        page, sound = visitor.client.get(visitor.address), visitor.client.get(source)
        headers = [
            [(name, value) for name, value in answer.headers if name != "Date"]
            for answer in (page, sound)
        ]
        told.append((page.text, headers))
        assert sound.data == spoken("en", drawn)

    assert told[0] == told[1]
    names = {name for name, _ in told[0][1][1]}
    assert not {"ETag", "Last-Modified", "Expires", "Content-Disposition"} & names
    assert ("Cache-Control", "no-store") in told[0][1][1]


def test_the_sound_is_sent_in_parts_to_browsers_that_ask_so(visitor: Visitor) -> None:
    source = visitor.page().value("audio", "src")
    whole = visitor.client.get(source).data

    part = visitor.client.get(source, headers={"Range": "bytes=0-1"})

    assert (part.status_code, part.data) == (206, whole[:2])
    assert part.headers["Content-Range"] == f"bytes 0-1/{len(whole)}"
