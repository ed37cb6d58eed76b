from __future__ import annotations

from collections.abc import Iterator

import pytest
from flask import Flask
from sqlalchemy import select

from studyapp.database.tables import Trial, Video
from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.pages import BrokenPageError, Page
from studyapp.rehearsal.participant import Participant
from tests.studyapp.rehearsal.steps import at_first_trial, browser


@pytest.fixture
def first_page(app: Flask, participant: Participant) -> Iterator[Page]:
    with browser(app) as client:
        yield at_first_trial(client, participant)[1]


def playing(*tokens: str) -> Page:
    videos = (
        f'<video src="/media/{token}.mp4" data-duration="1" data-watched-url="/w"></video>'
        for token in tokens
    )
    return Page("http://study.test/take/t", "".join(videos))


def tokens(eyes: Eyes) -> list[str]:
    with eyes.database.reading() as session:
        return list(session.scalars(select(Video.token).join(Video.trial).order_by(Trial.position)))


@pytest.mark.usefixtures("first_page")
def test_videos_of_several_trials_on_one_page_are_found_out(eyes: Eyes) -> None:
    with pytest.raises(BrokenPageError, match="videos of several trials"):
        eyes.look(playing(*tokens(eyes)[:2]))


@pytest.mark.usefixtures("first_page")
def test_a_video_that_is_none_of_the_trial_is_found_out(eyes: Eyes) -> None:
    with pytest.raises(BrokenPageError, match="shows 2 videos, not the 1 of its trial"):
        eyes.look(playing(tokens(eyes)[0], "unknown"))


@pytest.mark.usefixtures("first_page")
def test_digits_are_heard_by_nobody_for_whom_none_were_drawn(eyes: Eyes) -> None:
    with pytest.raises(BrokenPageError, match="for whom there is none"):
        eyes.hear(playing())
