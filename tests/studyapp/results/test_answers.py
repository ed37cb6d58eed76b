from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest
from click.testing import CliRunner

from motion.errors import InputError
from studyapp.cli.main import group
from studyapp.results.answers import answers_to_report, read_rehearsal
from studyapp.results.export.writing import export
from studyapp.study.folder import StudyFolder
from tests.studyapp.results.conftest import leave
from tests.support.studies.taking_part_steps import taking_part


@pytest.fixture
def folder(tiny_study: Path) -> StudyFolder:
    return StudyFolder(tiny_study)


def answer_once(folder: StudyFolder, file: Path) -> None:
    """Let somebody answer the first trial and stop."""
    with taking_part(folder.root, file.name) as participant:
        participant.enrol().begin().take_trial()


def test_real_answers_come_before_those_of_a_rehearsal_which_are_reported_on_request(
    folder: StudyFolder,
) -> None:
    with pytest.raises(InputError, match="nothing has been rehearsed"):
        read_rehearsal(folder)
    answer_once(folder, folder.rehearsal)
    assert answers_to_report(folder).origin == "rehearsal"

    answer_once(folder, folder.responses)
    real = answers_to_report(folder)
    assert real.origin == "participants" and real.stored is not None
    assert real.stored.study_sessions["completed"].tolist() == [False]
    assert read_rehearsal(folder).origin == "rehearsal"
    assert "--rehearsal" in CliRunner().invoke(group, ["report", "--help"]).output


def test_a_table_that_became_empty_is_not_left_as_it_was(
    folder: StudyFolder, tmp_path: Path
) -> None:
    answer_once(folder, folder.responses)
    earlier = tmp_path / "real_refusals.csv"
    earlier.write_text("study_session\n1\n", "utf-8")

    export(folder, tmp_path / "real.csv", rehearsal=False)

    assert pd.read_csv(earlier).empty


def test_what_was_kept_of_who_withdrew_is_exported_apart(
    folder: StudyFolder, tmp_path: Path
) -> None:
    definition = folder.definition
    text = definition.read_text("utf-8").replace("[page]\n", '[page]\nwithdrawn = "kept"\n')
    definition.write_text(text, "utf-8")
    answer_once(folder, folder.responses)
    leave(folder, 1)

    assert export(folder, tmp_path / "responses.csv").answers == 0
    assert export(folder, tmp_path / "withdrawn.csv", withdrawn=True).answers == 2
    stored = answers_to_report(folder).stored
    assert stored is not None
    assert stored.answers.empty
    assert stored.study_sessions["withdrawn"].tolist() == [True]
