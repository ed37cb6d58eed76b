"""A study as a folder for another lab: behavioural data after BIDS, and what repeats the report."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import metadata
from pathlib import Path
from typing import Any, Final

import pandas as pd
from sqlalchemy import select

from motion.errors import InputError
from motion.files import sha256_of, write_text
from studyapp.database.tables import StudyVersion
from studyapp.researchers.pseudonyms import PseudonymKey
from studyapp.results.answers import answers_in, of_present_design, snapshot
from studyapp.results.export.codebook import as_json, codebook, codebook_page, form_labels
from studyapp.results.export.columns import Column, TableColumns
from studyapp.results.export.shared_folder import (
    BIDS_VERSION,
    PARTICIPANT_ID,
    bids_table,
    copy_study,
    environment,
    folder_name,
    read_me,
    write_descriptions,
    write_stimuli_list,
    write_tsv,
)
from studyapp.results.export.tables import ExportedTable, Judged, exported_tables, judge
from studyapp.results.looks import note_way_out, with_looks_before
from studyapp.results.shared_answers import write_shared_answers
from studyapp.results.stored_answers import Answers, Source, stored_answers
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study

CHECKSUMS: Final = "SHA256SUMS"
STUDY: Final = Path("sourcedata") / "study"
"""What `motionjury report` is given."""


@dataclass(frozen=True, kw_only=True)
class Shared:
    """What was put into a folder for another lab.

    Attributes
    ----------
    study : Path
        What `motionjury report` is given there.
    participants : int
        Who are in it.
    remarks : tuple of str
        What could not be put in, or must be looked at before it is passed on, in sentences.
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
) -> Shared:
    """Write the study in `folder` into `out`, for another lab.

    Parameters
    ----------
    out : Path
        A folder that does not exist yet, or an empty one.
    videos : bool
        Whether the videos are copied too, not only listed.
    free_text : bool
        Whether what participants wrote in their own words is in it.
    reason : str
        Why answers are exported, for the log of looks.

    Raises
    ------
    InputError
        If there is something in `out`, nobody has answered, or the study cannot be read.
    """
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise InputError(
            "there is something at this place already",
            where=out,
            remedy="Give a folder that does not exist yet",
        )
    within = out.resolve().is_relative_to
    if within(folder.root.resolve()) and not within(folder.jobs.resolve()):
        raise InputError(
            "the folder for another lab would lie within the study",
            where=out,
            remedy="Give one that lies elsewhere",
        )
    origin: Source = "rehearsal" if rehearsal else "participants"
    draft = out.with_name(f".{out.name}-draft")
    shutil.rmtree(draft, ignore_errors=True)
    stored = _stored(folder, origin)
    look = note_way_out(folder, folder.study(), stored.answers, way="export", reason=reason)
    try:
        shared = _written(folder, draft, stored, origin, videos, free_text)
        if out.exists():
            out.rmdir()
        draft.replace(out)
    finally:
        shutil.rmtree(draft, ignore_errors=True)
    remarks = (*shared.remarks, look) if look else shared.remarks
    return replace(shared, study=out / STUDY, remarks=remarks)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Stored:
    """What is passed on of one state of the database."""

    answers: Answers
    judged: Judged
    tables: Mapping[str, ExportedTable]
    versions: Sequence[StudyVersion]


def _stored(folder: StudyFolder, origin: Source) -> _Stored:
    with snapshot(folder, origin) as session:
        if session is None:
            raise InputError(
                "nobody has taken part yet, so there is nothing to pass on",
                where=folder.root,
                remedy="Give the study folder itself to whom you want to show the design",
            )
        answers = answers_in(session, origin)
        judged = judge(folder.study(), answers)
        key = PseudonymKey.read_or_make(folder.pseudonym_key)
        return _Stored(
            answers=answers,
            judged=judged,
            tables={
                each.about.name: each
                for each in exported_tables(
                    session, stored_answers(session, in_full=True), key, judged
                )
            },
            versions=session.scalars(select(StudyVersion).order_by(StudyVersion.number)).all(),
        )


def _written(
    folder: StudyFolder,
    root: Path,
    given: _Stored,
    origin: Source,
    videos: bool,
    free_text: bool,
) -> Shared:
    study, tables = folder.study(), given.tables
    remarks = copy_study(folder, study, StudyFolder(root / STUDY), videos=videos)
    _write_answers(StudyFolder(root / STUDY), study, given, origin)
    if origin == "rehearsal" and folder.rehearsal_truth.exists():
        shutil.copyfile(folder.rehearsal_truth, root / STUDY / folder.rehearsal_truth.name)
    if folder.stimuli.exists():
        segments = tuple(folder.segments_of(study))
        write_stimuli_list(root / "sourcedata" / "stimuli.tsv", folder, study, segments)
    _write_versions(root / "sourcedata", given.versions)
    write_text(root / "sourcedata" / "environment.json", as_json(environment()))
    people = tables["participants"].frame
    # Of who withdrew, nothing is passed on but that somebody did, which the report counts.
    staying = people[people["state"] != "withdrawn"].reset_index(drop=True)
    described = _write_bids(root, study, tables, staying)
    _write_form(root / "phenotype", study, tables["form"].frame, staying, free_text=free_text)
    _write_about(root, study, people=len(staying))
    book: dict[str, Any] = codebook(folder, study, described)
    write_text(root / "sourcedata" / "codebook.md", codebook_page(book))
    if folder.report.joinpath("results.json").exists():
        results = root / "sourcedata" / "results.json"
        shutil.copyfile(folder.report / "results.json", results)
    _write_checksums(root)
    if given.judged.remark:
        remarks.append(given.judged.remark)
    return Shared(study=root / STUDY, participants=len(staying), remarks=tuple(remarks))


def _write_answers(copy: StudyFolder, study: Study, given: _Stored, origin: Source) -> None:
    stored = given.answers.stored
    if stored is None:
        return
    present = stored.study_sessions[of_present_design(stored.study_sessions)]
    first = None if present.empty else int(present["version"].min())
    write_shared_answers(
        copy.shared_answers,
        with_looks_before(study, stored),
        origin=origin,
        stated=next((each.definition for each in given.versions if each.number == first), None),
        stated_version=first,
    )


def _write_versions(folder: Path, versions: Sequence[StudyVersion]) -> None:
    """Write the study file of every version, and the digests of their designs."""
    for version in versions:
        write_text(folder / "versions" / f"version-{version.number}.toml", version.definition)
    designs = {str(version.number): version.design for version in versions}
    write_text(folder / "versions" / "designs.json", as_json({"design_sha256": designs}))


def _write_bids(
    root: Path, study: Study, tables: Mapping[str, ExportedTable], staying: pd.DataFrame
) -> list[tuple[TableColumns, Sequence[str]]]:
    """Write the participants and their answers, and return which columns each file has."""
    consents = dict(zip(staying["participant"], staying["consented_at"], strict=True))
    people, of_people = bids_table(staying, tables["participants"].about, consents)
    write_tsv(root / "participants.tsv", people, of_people)
    write_descriptions(root / "participants.json", of_people, study)
    task = _label(study.name)
    answers, of_answers = bids_table(tables[""].frame, tables[""].about, consents)
    # Whose answers they are, the file's name says.
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
    """Write what participants said about themselves, a column for each question."""
    asked = [
        question
        for stage in study.form.stages()
        for question in study.form.questions_at(stage)
        if free_text or question.kind != "text"
    ]
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


def _write_about(root: Path, study: Study, *, people: int) -> None:
    write_text(
        root / "dataset_description.json",
        as_json(
            {
                "Name": study.title,
                "BIDSVersion": BIDS_VERSION,
                "DatasetType": "raw",
                "GeneratedBy": [{"Name": "Motion Jury", "Version": metadata.version("motionjury")}],
            }
        ),
    )
    write_text(root / "README.md", read_me(study, people=people, study_folder=STUDY.as_posix()))
    write_text(root / ".bidsignore", f"{CHECKSUMS}\n")


def _write_checksums(root: Path) -> None:
    """Write what ``sha256sum --check`` reads; the list itself is not in it."""
    files = sorted(path for path in root.rglob("*") if path.is_file())
    lines = [f"{sha256_of(path)}  {path.relative_to(root).as_posix()}\n" for path in files]
    write_text(root / CHECKSUMS, "".join(lines))


def _label(name: str) -> str:
    """Return a study's name as a label of BIDS: letters and digits alone."""
    return "".join(letter for letter in name if letter.isascii() and letter.isalnum()) or "study"
