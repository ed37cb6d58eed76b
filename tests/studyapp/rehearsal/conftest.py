"""A small study of two comparisons, and the people who rehearse it."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from flask import Flask

from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.participant import Participant
from studyapp.rehearsal.simulation.population import Population, default_population
from studyapp.study.folder import StudyFolder
from studyapp.study.protocols.pairwise import PairwiseStudy
from tests.studyapp.rehearsal.steps import SPEED, application, participant_of
from tests.support.studies.added_condition import add_condition
from tests.support.studies.made_study import make_study
from tests.support.studies.redefining import redefine
from tests.support.studies.stored import opened


@pytest.fixture(scope="session")
def study() -> PairwiseStudy:
    return make_study(
        conditions={
            "rule_based": {"generator": "rule_based"},
            "mismatched": {"generator": "mismatched", "source": "rule_based"},
            "static": {"generator": "static"},
            "brought": {},
        }
    )


@pytest.fixture(scope="session")
def population(study: PairwiseStudy) -> Population:
    return default_population(study)


@pytest.fixture(scope="session")
def rendered(tiny_study_template: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The tiny study with a second comparison and three places in each.

    What its videos show is nothing to a simulated rater, so the two comparisons share them.
    """
    root = Path(shutil.copytree(tiny_study_template, tmp_path_factory.mktemp("rendered") / "study"))
    redefine(root, ("participants_per_comparison = 4", "participants_per_comparison = 3"))
    add_condition(root)
    return root


@pytest.fixture
def folder(rendered: Path, tmp_path: Path) -> StudyFolder:
    """A copy of the rendered study of one's own."""
    return StudyFolder(Path(shutil.copytree(rendered, tmp_path / "rehearsed")))


@pytest.fixture
def app(folder: StudyFolder) -> Iterator[Flask]:
    """The real application, as a rehearsal runs it."""
    with application(folder, SPEED) as made:
        yield made


@pytest.fixture
def eyes(folder: StudyFolder, app: Flask) -> Iterator[Eyes]:
    with opened(folder.rehearsal) as database:
        yield Eyes(database)


@pytest.fixture
def participant(folder: StudyFolder, eyes: Eyes) -> Participant:
    return participant_of(folder, eyes.database)
