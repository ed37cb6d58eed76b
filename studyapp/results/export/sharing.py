"""A study as a folder for another lab: behavioural data in BIDS, and what reproduces the report."""

import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import metadata
from pathlib import Path
from typing import Any, Final

import pandas as pd
from sqlalchemy import select

from motion.errors import InputError, counted
from motion.files import write_text
from studyapp.database.tables.study_session import StudyVersion
from studyapp.researchers.pseudonyms import PseudonymKey
from studyapp.results.answers import (
    answers_in,
    has_current_design,
    missing_answers,
    snapshot,
    write_shared_answers,
)
from studyapp.results.export.codebook import (
    as_json,
    codebook,
    codebook_page,
    form_labels,
    written_page,
)
from studyapp.results.export.columns import Column, TableColumns
from studyapp.results.export.shared_folder import (
    BIDS_VERSION,
    PARTICIPANT_ID,
    bids_table,
    copy_study,
    environment,
    folder_name,
    write_descriptions,
    write_stimuli_list,
    write_tsv,
)
from studyapp.results.export.tables import ExportedTable, exclusions, exported_tables
from studyapp.results.looks import drop_current_looks, record_look
from studyapp.results.stored_answers import Answers, Source, stored_answers
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study

STUDY: Final = Path("sourcedata") / "study"
"""The study folder for `motionjury report`."""


@dataclass(frozen=True, kw_only=True)
class Shared:
    """The contents of a folder for another lab.

    Attributes
    ----------
    study : Path
        Its study folder, for `motionjury report`.
    participants : int
        Number of participants.
    remarks : tuple of str
        What is missing, or must be checked before sharing.
    """

    study: Path
    participants: int
    remarks: tuple[str, ...]


def share(
    folder: StudyFolder,
    out: Path,
    *,
    rehearsal: bool = False,
    videos: bool = False,
    free_text: bool = False,
    reason: str = "",
    on_step: Callable[[str], None] = lambda _step: None,
) -> Shared:
    """Write the study in `folder` into `out`, for another lab.

    Parameters
    ----------
    out : Path
        A new or empty folder.
    videos : bool
        Copy the videos, instead of only listing them.
    free_text : bool
        Include free text by participants.
    reason : str
        The reason in the log of looks.
    on_step : callable
        Called with the name of the next step.

    Raises
    ------
    InputError
        If `out` is not empty, nobody has answered, or the study cannot be read.
    """
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise InputError(
            "this folder is not empty",
            where=out,
            remedy="Choose a new folder",
        )
    is_within = out.resolve().is_relative_to
    if is_within(folder.root.resolve()) and not is_within(folder.jobs.resolve()):
        raise InputError(
            "the folder for another lab would lie within the study",
            where=out,
            remedy="Choose a folder elsewhere",
        )
    origin: Source = "rehearsal" if rehearsal else "participants"
    draft = out.with_name(f".{out.name}-draft")
    shutil.rmtree(draft, ignore_errors=True)
    on_step("reading answers")
    study = folder.study()
    with snapshot(folder, origin) as session:
        if session is None:
            raise missing_answers(folder, origin)
        answers = answers_in(session, origin)
        full, excluded = stored_answers(session, in_full=True), exclusions(study, answers)
        key = PseudonymKey.read_or_make(folder.pseudonym_key)
        exported = exported_tables(session, full, key, excluded)
        versions = session.scalars(select(StudyVersion).order_by(StudyVersion.number)).all()
    tables = {table.about.name: table for table in exported}
    look = record_look(folder, study, answers, way="export", reason=reason)
    people = tables["participants"].frame
    # Participants who withdrew are only counted, by the report.
    staying = people[people["state"] != "withdrawn"].reset_index(drop=True)
    try:
        on_step("copying the study")
        remarks = copy_study(folder, study, StudyFolder(draft / STUDY), videos=videos)
        _write_answers(StudyFolder(draft / STUDY), study, answers, versions, origin)
        if origin == "rehearsal" and folder.rehearsal_truth.exists():
            shutil.copyfile(folder.rehearsal_truth, draft / STUDY / folder.rehearsal_truth.name)
        _write_sources(draft / "sourcedata", folder, study, versions)
        described = _write_bids(draft, study, tables, staying)
        form = tables["form"].frame
        _write_form(draft / "phenotype", study, form, staying, free_text=free_text)
        _write_about(draft, study, origin, people=len(staying))
        book: dict[str, Any] = codebook(folder, study, origin, described)
        write_text(draft / "sourcedata" / "codebook.md", codebook_page(book))
        if out.exists():
            out.rmdir()
        draft.replace(out)
    finally:
        shutil.rmtree(draft, ignore_errors=True)
    return Shared(
        study=out / STUDY,
        participants=len(staying),
        remarks=tuple(filter(None, (*remarks, look))),
    )


def _write_sources(
    out: Path, folder: StudyFolder, study: Study, versions: Sequence[StudyVersion]
) -> None:
    """Write what BIDS has no place for: videos, versions and results."""
    if folder.stimuli.exists():
        segments = folder.segments_of(study)
        write_stimuli_list(out / "stimuli.tsv", folder, study, segments)
    _write_versions(out, versions)
    write_text(out / "environment.json", as_json(environment()))
    if folder.report.joinpath("results.json").exists():
        shutil.copyfile(folder.report / "results.json", out / "results.json")


def _write_answers(
    copy: StudyFolder,
    study: Study,
    answers: Answers,
    versions: Sequence[StudyVersion],
    origin: Source,
) -> None:
    stored = answers.stored
    if stored is None:
        return
    present = stored.study_sessions[has_current_design(stored.study_sessions)]
    first = None if present.empty else int(present["version"].min())
    write_shared_answers(
        copy.shared_answers,
        drop_current_looks(study, stored),
        origin=origin,
        stated=next((each.definition for each in versions if each.number == first), None),
        stated_version=first,
    )


def _write_versions(folder: Path, versions: Sequence[StudyVersion]) -> None:
    """Write the study files of all versions, and the digests of their designs."""
    for version in versions:
        write_text(folder / "versions" / f"version-{version.number}.toml", version.definition)
    designs = {str(version.number): version.design for version in versions}
    write_text(folder / "versions" / "designs.json", as_json({"design_sha256": designs}))


def _write_bids(
    root: Path, study: Study, tables: Mapping[str, ExportedTable], staying: pd.DataFrame
) -> list[tuple[TableColumns, Sequence[str]]]:
    """Write participants and answers; return the columns of each file."""
    consents = dict(zip(staying["participant"], staying["consented_at"], strict=True))
    people, of_people = bids_table(staying, tables["participants"].about, consents)
    write_tsv(root / "participants.tsv", people, of_people)
    write_descriptions(root / "participants.json", of_people, study)
    task = _label(study.name)
    answers, of_answers = bids_table(tables[""].frame, tables[""].about, consents)
    # The file's name identifies the participant.
    own = replace(of_answers, columns=of_answers.columns[1:])
    for name in people["participant_id"]:
        rows = answers[answers["participant_id"] == name].reset_index(drop=True)
        write_tsv(root / name / "beh" / f"{name}_task-{task}_beh.tsv", rows, own)
    write_descriptions(
        root / f"task-{task}_beh.json",
        own,
        study,
        more={
            "TaskName": study.name,
            "TaskDescription": f"{study.title} (protocol {study.protocol}).",
        },
        labels={"question": {question.name: question.text for question in study.questions}},
    )
    videos, of_videos = bids_table(tables["watching"].frame, tables["watching"].about, consents)
    write_tsv(root / "sourcedata" / "watching.tsv", videos, of_videos)
    write_descriptions(root / "sourcedata" / "watching.json", of_videos, study)
    return [
        (of_people, ["participants.tsv"]),
        (own, [f"sub-*/beh/*_task-{task}_beh.tsv"]),
        (of_videos, ["sourcedata/watching.tsv"]),
    ]


def _write_form(
    folder: Path,
    study: Study,
    given: pd.DataFrame,
    people: pd.DataFrame,
    *,
    free_text: bool,
) -> None:
    """Write the answers to the form, with a column per question."""
    asked = [question for _, question in study.form.asked() if free_text or question.kind != "text"]
    if not asked:
        return
    columns = [
        Column(
            question.name,
            "text",
            question.text,
            missing="it was not answered",
            free_text=question.kind == "text",
        )
        for question in asked
    ]
    wide = pd.DataFrame({"participant_id": people["participant"].map(folder_name)})
    for question in asked:
        own = given[given["question"] == question.name]
        values = dict(zip(own["participant"], own["value"], strict=True))
        wide[question.name] = people["participant"].map(values).astype("string")
    about = TableColumns(name="form", title="", columns=(PARTICIPANT_ID, *columns))
    write_tsv(folder / "form.tsv", wide, about)
    write_descriptions(
        folder / "form.json",
        about,
        study,
        labels={question.name: form_labels(question) for question in asked},
    )


def _write_about(root: Path, study: Study, origin: Source, *, people: int) -> None:
    """Write pages about the folder, which say where no person answered."""
    mark = "[rehearsal] " if origin == "rehearsal" else ""
    write_text(
        root / "dataset_description.json",
        as_json(
            {
                "Name": f"{mark}{study.title}",
                "BIDSVersion": BIDS_VERSION,
                "DatasetType": "raw",
                "GeneratedBy": [{"Name": "Motion Jury", "Version": metadata.version("motionjury")}],
            }
        ),
    )
    page = written_page(
        "read_me.md",
        study=study,
        origin=origin,
        people=counted(people, "participant"),
        has_form=(root / "phenotype").exists(),
        has_stimuli=(root / "sourcedata" / "stimuli.tsv").exists(),
        study_folder=STUDY.as_posix(),
    )
    write_text(root / "README.md", page)


def _label(name: str) -> str:
    """Return a study's name as a BIDS label of letters and digits."""
    return "".join(letter for letter in name if letter.isascii() and letter.isalnum()) or "study"
