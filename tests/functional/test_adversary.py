"""In whole study sessions of every protocol, nothing received reveals what is hidden.

An adversary keeps all that a browser receives, except the pictures and the sound themselves, and
learns from half of the study sessions, with the truth given, to guess the other half. Leaks that
are planted on purpose show that it would find one.
"""

from __future__ import annotations

import random
import shutil
from base64 import urlsafe_b64encode
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Final

import pytest

from renderer.encoder import pad_to_equal_size
from studyapp.database.tables import Trial, TrialStimulus
from studyapp.session.served_study import ServedStudy
from studyapp.study.design.trial import Content, Stimulus
from studyapp.study.folder import StudyFolder
from studyapp.study.media import finished_video_path
from studyapp.web.app import create_app
from studyapp.web.site import attach, site_of
from tests.functional.adversary import unlike_videos
from tests.functional.adversary.facts import facts_of, stimulus_facts, trial_facts
from tests.functional.adversary.guessing import Guess, Received, guesses
from tests.functional.adversary.recording import Exchange, RecordedTrial, RecordingParticipant
from tests.functional.adversary.studies import STUDIES, instructs, write_study
from tests.support.studies.taking_part_steps import SetClock

pytestmark = pytest.mark.slow

SESSIONS: Final = 24
"""Half of them are guessed: eight study sessions can exchange what is true of them in so many ways
that a perfect guess is far less probable than `CHANCE` allows, even of one catch trial in six."""
CHANCE: Final = 0.01
"""The largest probability of a false alarm."""
GUESSES: Final = len(STUDIES) * 2 * 2
"""Of conditions and of kinds, each half of every study's sessions."""

Trials = list[RecordedTrial]
Change = Callable[[Exchange, Trial, Content | None], Exchange]
"""Changes what was received, given the trial and, for a video, its content."""


@dataclass(frozen=True)
class RecordedStudy:
    """A study, and everything that was received by those who took part in it."""

    folder: StudyFolder
    sessions: list[Trials]
    questions: bool


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], StudyFolder]:
    """Return a function that makes each study once."""
    return cache(lambda name: write_study(tmp_path_factory.mktemp(name) / "study", name))


@pytest.fixture(scope="module")
def recorded(written: Callable[[str], StudyFolder]) -> Callable[[str], RecordedStudy]:
    """Return a function that has each study taken part in once."""

    @cache
    def take_part(name: str) -> RecordedStudy:
        folder = written(name)
        clock = SetClock()
        app = create_app(folder.root)
        site = site_of(app)
        with pytest.MonkeyPatch.context() as patch:
            # The same tokens, and so the same guesses, each time.
            patch.setattr("secrets.token_urlsafe", seeded_tokens())
            attach(app, replace(site, clock=clock))
            sessions = [RecordingParticipant(app, clock).take_part() for _ in range(SESSIONS)]
        site.database.close()
        return RecordedStudy(folder, sessions, questions=not instructs(name))

    return take_part


def seeded_tokens() -> Callable[[int], str]:
    chance = random.Random(20260504)  # noqa: S311
    return lambda size: urlsafe_b64encode(chance.randbytes(size)).decode().rstrip("=")


def shape(trials: Trials) -> tuple[object, ...]:
    """Return the public facts of a study session: its parts, and the speech heard twice."""
    return tuple(
        (t.truth.part, len(t.truth.conditions), t.truth.repeats, t.truth.kind == "practice")
        for t in trials
    )


def by_condition(sessions: Sequence[Trials], *, questions: bool) -> list[Received]:
    """Return the sessions, an item for each stimulus: what it shows, and with whose speech."""
    received = []
    for trials in sessions:
        rows, truth = [], []
        for trial in trials:
            facts = stimulus_facts(trial, questions=questions)
            judged = [stimulus for stimulus in trial.truth.stimuli if stimulus.number]
            rows += [facts[stimulus.number] for stimulus in judged]
            truth += [f"{stimulus.condition} {_sound(stimulus)}" for stimulus in judged]
        received.append(Received(rows, truth, shape(trials)))
    return received


def by_kind(sessions: Sequence[Trials], *, questions: bool) -> list[Received]:
    """Return the sessions, an item for each trial: its kind."""
    return [
        Received(
            [trial_facts(t, questions=questions) for t in trials],
            [t.truth.kind for t in trials],
            shape(trials),
        )
        for trials in sessions
    ]


def _sound(stimulus: TrialStimulus) -> str:
    if stimulus.speech is None:
        return "muted"
    return "own" if stimulus.speech == stimulus.segment else "other"


def better_than_chance(study: RecordedStudy, change: Change | None = None) -> Iterator[Guess]:
    """Yield guesses better than chance from what was received, optionally changed."""
    sessions = study.sessions
    if change is not None:
        sessions = [[_changed(trial, change) for trial in trials] for trials in sessions]
    for receive in (by_condition, by_kind):
        received = receive(sessions, questions=study.questions)
        assert len({truth for session in received for truth in session.truth}) > 1
        yield from (guess for guess in guesses(received) if guess.p < CHANCE / GUESSES)


@pytest.mark.parametrize("name", STUDIES)
def test_an_adversary_does_no_better_than_chance(
    recorded: Callable[[str], RecordedStudy], name: str
) -> None:
    assert list(better_than_chance(recorded(name))) == []


@pytest.mark.parametrize("name", STUDIES)
def test_blinded_files_do_not_differ_in_size_time_or_metadata(
    written: Callable[[str], StudyFolder], name: str
) -> None:
    facts_of_segment = defaultdict(list)
    for content, video in ServedStudy.read(written(name).root).videos.items():
        data = video.file.read_bytes()
        facts_of_segment[content[0].segment, content[0].speech is None].append(
            {"": len(data), **facts_of(data)}
        )

    assert len(facts_of_segment) >= unlike_videos.SEGMENTS
    for of_segment in facts_of_segment.values():
        assert len(of_segment) > 1
        assert all(facts == of_segment[0] for facts in of_segment)


def _changed(trial: RecordedTrial, change: Change) -> RecordedTrial:
    shown = {
        label: tuple(
            Stimulus(condition=s.condition, segment=s.segment, speech=s.speech)
            for s in trial.truth.stimuli
            if s.number in numbers
        )
        for label, numbers in trial.numbers.items()
    }
    return replace(
        trial,
        pages=[change(exchange, trial.truth, None) for exchange in trial.pages],
        videos={
            label: [change(exchange, trial.truth, shown[label]) for exchange in exchanges]
            for label, exchanges in trial.videos.items()
        },
    )


Files = Callable[[StudyFolder, Path], Mapping[Content, bytes]]
"""Replaces the files of a study by others, made in a folder."""


def without_padding(study: StudyFolder, _: Path) -> Mapping[Content, bytes]:
    files = {}
    for content, video in ServedStudy.read(study.root).videos.items():
        data = video.file.read_bytes()
        end = data.index(b"mdat") - 4
        files[content] = data[: end + int.from_bytes(data[end : end + 4], "big")]
    return files


def as_other_tools_wrote_them(study: StudyFolder, folder: Path) -> Mapping[Content, bytes]:
    copies: dict[Content, Path] = {}
    for content in ServedStudy.read(study.root).videos:
        original = finished_video_path(study.videos, content[0])
        copies[content] = folder / "-".join(original.parts[-2:])
        shutil.copyfile(original, copies[content])
    pad_to_equal_size(list(copies.values()))
    return {content: copy.read_bytes() for content, copy in copies.items()}


def by_an_encoder_that_follows_the_picture(_: StudyFolder, folder: Path) -> Mapping[Content, bytes]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(unlike_videos, "PICTURE", {"crf": "18"})
        served = ServedStudy.read(write_study(folder / "study", "players").root)
    return {content: video.file.read_bytes() for content, video in served.videos.items()}


@pytest.mark.parametrize(
    "files",
    [without_padding, as_other_tools_wrote_them, by_an_encoder_that_follows_the_picture],
)
def test_the_adversary_finds_revealing_files(
    recorded: Callable[[str], RecordedStudy], tmp_path: Path, files: Files
) -> None:
    others = files(recorded("players").folder, tmp_path)

    def replaced(exchange: Exchange, _: Trial, content: Content | None) -> Exchange:
        if content is None or exchange.name != "whole":
            return exchange
        return replace(exchange, body=others[content])

    assert any(better_than_chance(recorded("players"), replaced))


def in_a_header(exchange: Exchange, trial: Trial, content: Content | None) -> Exchange:
    del trial
    if content is None:
        return exchange
    own = ("X-Served-In", str(100 + len(content[0].condition)))
    return replace(exchange, headers=(*exchange.headers, own))


def in_tokens(exchange: Exchange, trial: Trial, content: Content | None) -> Exchange:
    body = exchange.body
    for video in trial.videos if content is None else ():
        telling = video.stimuli[0].condition[0] + video.token[1:]
        body = body.replace(video.token.encode(), telling.encode())
    return replace(exchange, body=body)


def in_one_byte_of_catch_trials(
    exchange: Exchange, trial: Trial, content: Content | None
) -> Exchange:
    if content is None and exchange.name == "page" and trial.kind == "catch":
        return replace(exchange, body=exchange.body + b"\n")
    return exchange


@pytest.mark.parametrize("leak", [in_a_header, in_tokens, in_one_byte_of_catch_trials])
def test_the_adversary_finds_planted_leaks(
    recorded: Callable[[str], RecordedStudy], leak: Change
) -> None:
    assert any(better_than_chance(recorded("players"), leak))
