"""The sound check's page: only listening reveals the digits."""

import io
import wave
from itertools import combinations
from typing import get_args

import numpy as np
import pyloudnorm
import pytest
from flask import Flask
from numpy.typing import NDArray
from sqlalchemy import select

from studyapp.database.tables.study_session import StudySession
from studyapp.study.settings.presentation import Language
from studyapp.web.participants.sound_check import spoken_digits
from studyapp.web.site import site_of
from tests.studyapp.web.conftest import Serve
from tests.studyapp.web.visitor import Visitor
from tests.support.studies.taking_part_steps import SetClock


def samples_of(sound: bytes) -> tuple[NDArray[np.float64], int]:
    with wave.open(io.BytesIO(sound)) as file:
        samples = np.frombuffer(file.readframes(file.getnframes()), np.int16) / 32768
        return samples, file.getframerate()


@pytest.mark.parametrize("language", get_args(Language))
def test_digits_differ_only_in_the_sound(language: Language) -> None:
    alone = [samples_of(spoken_digits(language, str(digit))) for digit in range(10)]

    assert len({len(samples) for samples, _ in alone}) == 1
    for first, second in combinations(alone, 2):
        assert np.abs(first[0] - second[0]).max() > 0.1
    for samples, rate in (samples_of(spoken_digits(language, digits)) for digits in ("012", "999")):
        assert pyloudnorm.Meter(rate).integrated_loudness(samples) == pytest.approx(-23, abs=3)
        assert np.abs(samples).max() < 0.9
    both, _ = samples_of(spoken_digits(language, "37"))
    assert np.array_equal(both[: len(alone[3][0])], alone[3][0])


@pytest.fixture
def listening(serve: Serve) -> Flask:
    return serve(("[page]\n", "[page]\nsound_check = true\n"))


@pytest.fixture
def visitor(listening: Flask) -> Visitor:
    """Return a participant at the sound check."""
    return Visitor(listening, SetClock()).enrol()


def test_page_and_headers_do_not_depend_on_the_digits(listening: Flask, visitor: Visitor) -> None:
    source = visitor.page().value("audio", "src")
    # Some browsers play only files that support byte ranges.
    whole = visitor.client.get(source).data
    part = visitor.client.get(source, headers={"Range": "bytes=0-1"})
    assert (part.status_code, part.data) == (206, whole[:2])
    answers_by_digits = []
    for drawn in ("123", "987"):
        with site_of(listening).database.writing() as session:
            session.scalars(select(StudySession)).one().sound_digits = drawn
        page, sound = visitor.client.get(visitor.address), visitor.client.get(source)
        headers = [
            [(name, value) for name, value in answer.headers if name != "Date"]
            for answer in (page, sound)
        ]
        answers_by_digits.append((page.text, headers))
        assert sound.data == spoken_digits("en", drawn)

    assert answers_by_digits[0] == answers_by_digits[1]
    names = {name for name, _ in answers_by_digits[0][1][1]}
    assert not {"ETag", "Last-Modified", "Expires", "Content-Disposition"} & names
    assert ("Cache-Control", "no-store") in answers_by_digits[0][1][1]
