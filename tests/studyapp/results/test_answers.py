from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import pandas as pd
import pytest
from click.testing import CliRunner

from motion.errors import InputError
from studyapp.cli.main import group
from studyapp.results.analysed_tasks import MIDDLE, study_answers
from studyapp.results.answers import answers_to_report, read_rehearsal
from studyapp.results.export.tables import export
from studyapp.results.stated_beforehand import exclusions_of
from studyapp.results.stored_answers import Answers, StoredAnswers, stored_answers
from studyapp.session.enrolment import Arrival
from studyapp.session.refusal import ConflictError, log_refusal
from studyapp.study.folder import StudyFolder
from studyapp.study.protocols.ranking import RankingStudy
from studyapp.study.settings.study import Study
from tests.support.studies.exported import responses_table
from tests.support.studies.finished_study import PROTOCOLS
from tests.support.studies.form_questions import ADULT, ELIGIBILITY
from tests.support.studies.redefining import redefine
from tests.support.studies.stored import reading
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


def test_kept_answers_of_withdrawn_participants_are_exported_separately(
    folder: StudyFolder, tmp_path: Path
) -> None:
    redefine(folder.root, ("[page]\n", '[page]\nwithdrawn = "kept"\n'), added=ELIGIBILITY)
    with taking_part(folder.root) as participant:
        participant.arrive(Arrival(visit="visit", form=ADULT)).begin().take_trial()
        refusal = ConflictError("No.", "Try again.")
        log_refusal(participant.database, participant.token, "answers", refusal, participant.clock)
        participant.withdraw()
    # A table that became empty is overwritten.
    (tmp_path / "responses_refusals.csv").write_text("study_session\n1\n", "utf-8")

    assert export(folder, tmp_path / "responses.csv").answers == 0
    for table in ("form", "watching", "refusals"):
        assert pd.read_csv(tmp_path / f"responses_{table}.csv").empty
    assert export(folder, tmp_path / "withdrawn.csv", withdrawn=True).answers == 2
    assert len(pd.read_csv(tmp_path / "withdrawn_form.csv")) == 1
    stored = answers_to_report(folder).stored
    assert stored is not None
    assert stored.answers.empty
    assert stored.study_sessions["withdrawn"].tolist() == [True]


Once = Callable[..., Path]


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_table_and_export_have_the_same_answers(answered_once: Once, protocol: str) -> None:
    folder = StudyFolder(answered_once(protocol))
    with reading(folder.responses) as session:
        exported = responses_table(session)
        tables, _ = study_answers(folder.study(), stored_answers(session))

    assert sum(map(len, tables.values())) == len(exported)
    for name, table in tables.items():
        answer = "rank" if name == "ranking" else "response"
        shift = 0 if name in ("rating", "ranking") else MIDDLE
        part = exported
        if protocol == "mismatch":
            part = exported[exported["part"] == ("fit" if name == "mismatch" else "realism")]
        assert table[answer].astype(int).tolist() == (part["value"] + shift).tolist()
        assert table["participant"].astype(int).tolist() == part["study_session"].tolist()
        assert table["trial"].astype(int).tolist() == part["position"].tolist()
        assert table["watched"].astype(float).tolist() == part["watched"].tolist()


def test_a_block_is_named_even_if_no_other_has_answers(answered_once: Once) -> None:
    folder = StudyFolder(answered_once("ranking"))
    study = folder.study()
    assert isinstance(study, RankingStudy)
    with reading(folder.responses) as session:
        stored = stored_answers(session)
    (block,) = study.blocks
    blocks = (block, block.model_copy(update={"name": "unanswered"}))

    (alone, _), (tables, _) = (
        study_answers(each, stored) for each in (study, study.model_copy(update={"blocks": blocks}))
    )

    assert "set" not in alone["ranking"]
    assert set(tables["ranking"]["set"]) == {block.name}


def test_right_answers_and_failures_match_the_protocol(answered_once: Once) -> None:
    folder = StudyFolder(answered_once("pairwise"))
    with reading(folder.responses) as session:
        tables, facts = study_answers(folder.study(), stored_answers(session))
    table = tables["pairwise"]

    assert len(facts) == 2
    assert (table[table["kind"] == "main"]["correct_side"] == "").all()
    for participant, known in facts.items():
        own = table[table["participant"] == participant]
        catch = own[own["kind"] == "catch"].iloc[0]
        assert catch[catch["correct_side"]] == "real"
        towards = int(catch["response"]) - MIDDLE
        right = towards > 0 if catch["correct_side"] == "right" else towards < 0
        assert known.failed_catch == int(not right)
        asked = own[own["kind"] == "attention"].iloc[0]
        assert int(asked["instructed"]) in (1, 2, 4, 5)
        assert known.failed_attention == int(asked["response"] != asked["instructed"])
        assert (known.trials, known.settled) == (6, 6)


@pytest.mark.parametrize(
    ("after_look", "when"),
    [
        ([False, False], "before anybody had looked at results."),
        ([True, False], "1 of them after somebody had looked at results."),
        ([True, True], "after somebody had looked at results."),
    ],
)
def test_a_report_says_whether_results_had_been_seen(after_look: list[bool], when: str) -> None:
    sessions = pd.DataFrame(
        {"excluded_because": ["asleep", "left", ""], "excluded_after_look": [*after_look, False]}
    )
    study = cast(Study, SimpleNamespace(settled_exclusions=()))
    stored = cast(StoredAnswers, SimpleNamespace(study_sessions=sessions))
    found = exclusions_of(study, Answers(origin="participants", stored=stored, stated=study))

    assert found.notes == (f"Researchers excluded 2 participants by hand, {when}",)
