"""In whole study sessions of every protocol, nothing received depends on what is hidden.

Study sessions are recorded twice. The second time, trials of the same outward shape have exchanged
what is hidden of them: their kinds, their conditions, and the sides of these. Everything received
must stay the same, byte for byte, except the pictures and the sound themselves.
"""

import random
import shutil
from base64 import urlsafe_b64encode
from collections import defaultdict
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from renderer.encoder import pad_to_equal_size
from studyapp.session.served_study import ServedStudy
from studyapp.study.design.trial import Content, PlannedTrial, Stimulus
from studyapp.study.folder import StudyFolder
from studyapp.study.media import finished_video_path
from studyapp.web.app import create_app
from studyapp.web.site import attach, site_of
from tests.functional.blinding import unlike_videos
from tests.functional.blinding.receiving import Received, Recorder, described
from tests.functional.blinding.studies import STUDIES, write_study
from tests.support.studies.taking_part_steps import SetClock

pytestmark = pytest.mark.slow

SESSIONS = 4
EXCHANGED = ("main", "catch", "attention")
"""Kinds that nobody can tell apart; practice is announced, and a repeat is known by its speech."""

Plan = tuple[PlannedTrial, ...]
Written = Callable[[str], StudyFolder]


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Written:
    """Return a function that makes each study once."""
    return cache(lambda name: write_study(tmp_path_factory.mktemp(name) / "study", name))


def exchanged(plan: Plan) -> Plan:
    """Give what is hidden of each trial to the next one of the same part and number of stimuli."""
    alike: defaultdict[object, list[PlannedTrial]] = defaultdict(list)
    for trial in plan:
        if trial.kind in EXCHANGED:
            alike[trial.part, len(trial.conditions)].append(trial)
    given = {
        trial.position: _with_hidden_of(other, trial)
        for trials in alike.values()
        for trial, other in zip(trials, (*trials[1:], trials[0]), strict=True)
    }
    return tuple(given.get(trial.position, trial) for trial in plan)


def _with_hidden_of(other: PlannedTrial, trial: PlannedTrial) -> PlannedTrial:
    """Return `trial` with the kind and the mirrored conditions of `other`."""
    strange = next((s.speech for s in trial.stimuli if s.speech not in (None, s.segment)), None)

    def here(stimulus: Stimulus) -> Stimulus:
        own = stimulus.speech == stimulus.segment
        speech = stimulus.speech and (trial.segment.name if own else strange)
        return replace(stimulus, segment=trial.segment.name, speech=speech)

    return replace(
        trial,
        kind=other.kind,
        videos=tuple(tuple(map(here, content[::-1])) for content in other.videos[::-1]),
        expected=other.expected and len(other.conditions) + 1 - other.expected,
        instructed=other.instructed,
    )


def hidden(plans: Iterable[Plan]) -> list[list[tuple[object, ...]]]:
    return [[(trial.kind, trial.videos) for trial in plan] for plan in plans]


def take_part(name: str, root: Path, change: Callable[[Plan], Plan]) -> tuple[Any, list[Received]]:
    """Return what was hidden from, and everything received by, those who took part in a study."""
    folder = StudyFolder(root)
    kind, clock, chance = type(folder.study()), SetClock(), random.Random(20260504)  # noqa: S311
    plan, plans = kind.plan, list[Plan]()

    def changed(*args: Any) -> Plan:
        plans.append(change(plan(*args)))
        return plans[-1]

    def token(size: int) -> str:
        return urlsafe_b64encode(chance.randbytes(size)).decode().rstrip("=")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(kind, "plan", changed)
        patch.setattr("secrets.token_urlsafe", token)
        patch.setattr("studyapp.session.places.RANDOM", chance)
        app = create_app(root)
        site = site_of(app)
        attach(app, replace(site, clock=clock))
        received: list[Received] = []
        for _ in range(SESSIONS):
            # Attention checks say by their words what they are.
            questions = STUDIES[name]["attention"] is None
            received += Recorder(app, clock, questions=questions).take_part()
    site.database.close()
    folder.responses.unlink()
    return hidden(plans), received


@pytest.mark.parametrize("name", STUDIES)
def test_nothing_received_depends_on_kinds_conditions_or_sides(written: Written, name: str) -> None:
    root = written(name).root
    one_plan, one = take_part(name, root, lambda plan: plan)
    other_plan, other = take_part(name, root, exchanged)

    moved = sum(
        a != b
        for pair in zip(one_plan, other_plan, strict=True)
        for a, b in zip(*pair, strict=True)
    )
    assert moved > len(one_plan)
    assert len(one) == len(other) > 20 * SESSIONS
    for before, after in zip(one, other, strict=True):
        assert before == after


def sorts_of_files(videos: Iterable[tuple[Content, Path]]) -> list[int]:
    """Return how many different descriptions the files of each segment have."""
    sorts = defaultdict(set)
    for content, file in videos:
        sorts[content[0].segment, content[0].speech is None].add(described(file.read_bytes()))
    assert len(sorts) >= unlike_videos.SEGMENTS
    return [len(different) for different in sorts.values()]


@pytest.mark.parametrize("name", STUDIES)
def test_blinded_files_do_not_differ_in_size_time_or_metadata(written: Written, name: str) -> None:
    videos = ServedStudy.read(written(name).root).videos
    assert set(sorts_of_files((content, videos[content].file) for content in videos)) == {1}


def as_other_tools_wrote_them(study: StudyFolder, folder: Path) -> list[Path]:
    served = ServedStudy.read(study.root)
    originals = [finished_video_path(study.videos, content[0]) for content in served.videos]
    copies = [folder / "-".join(original.parts[-2:]) for original in originals]
    for original, copy in zip(originals, copies, strict=True):
        shutil.copyfile(original, copy)
    pad_to_equal_size(copies)
    return copies


def by_an_encoder_that_follows_the_picture(_: StudyFolder, folder: Path) -> list[Path]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(unlike_videos, "PICTURE", {"crf": "18"})
        served = ServedStudy.read(write_study(folder / "study", "players").root)
    return [video.file for video in served.videos.values()]


@pytest.mark.parametrize(
    "files", [as_other_tools_wrote_them, by_an_encoder_that_follows_the_picture]
)
def test_revealing_files_would_be_found(
    written: Written, tmp_path: Path, files: Callable[[StudyFolder, Path], list[Path]]
) -> None:
    study = written("players")
    videos = zip(ServedStudy.read(study.root).videos, files(study, tmp_path), strict=True)
    assert max(sorts_of_files(videos)) > 1
