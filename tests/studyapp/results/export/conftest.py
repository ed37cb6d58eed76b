import shutil
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from studyapp.session.enrolment import Arrival
from studyapp.study.folder import StudyFolder
from tests.studyapp.results.export.people import FORM, SAID
from tests.support.studies.taking_part_steps import taking_part


@pytest.fixture(scope="session")
def recruited_once(
    answered_once: Callable[..., Path], tmp_path_factory: pytest.TempPathFactory
) -> Callable[[str], Path]:
    """Return a function that gives a study that two have answered, and one is recruited for."""

    @cache
    def make(protocol: str) -> Path:
        root = tmp_path_factory.mktemp("recruited") / "study"
        shutil.copytree(answered_once(protocol, stop_after=1, more=FORM), root)
        # Somebody arrives by a recruiter's link, fills in a form, and views the first trial.
        with taking_part(root) as participant:
            participant.arrive(Arrival(**SAID)).begin().look()
        return root

    return make


@pytest.fixture
def answered(recruited_once: Callable[[str], Path], tmp_path: Path) -> Callable[[str], StudyFolder]:
    """Return a function that copies such a study for one test."""
    return lambda protocol: StudyFolder(
        shutil.copytree(recruited_once(protocol), tmp_path / protocol)
    )
