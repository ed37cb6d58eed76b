"""A study on Prolific: making, publishing, watching and paying."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from motion.errors import InputError
from motion.listing import listed
from studyapp.recruitment.payment import (
    Judged,
    Ours,
    arrived_in,
    by_submission,
    judge_submission,
)
from studyapp.recruitment.prolific_client import ProlificClient, ProlificStudy, Submission
from studyapp.recruitment.prolific_draft import internal_name, prolific_draft
from studyapp.recruitment.record import read_made_there, write_made_there
from studyapp.study.folder import StudyFolder


@dataclass(frozen=True, kw_only=True)
class JudgedSubmission:
    """One submission, what the study knows of its participant, and what is to be done."""

    submission: Submission
    ours: Ours
    judged: Judged


@dataclass(frozen=True, kw_only=True)
class ProlificStatus:
    """How a study on Prolific goes.

    Attributes
    ----------
    there_and_here : mapping
        How many submissions are in each state on Prolific and here.
    missing_there : tuple of str
        Participants who are here but have no submission there.
    """

    study: ProlificStudy
    submissions: tuple[JudgedSubmission, ...]
    there_and_here: dict[tuple[str, Ours], int]
    missing_there: tuple[str, ...]


def draft_of(folder: StudyFolder, address: str) -> dict[str, Any]:
    """Return what `create` sends."""
    study = folder.study()
    return prolific_draft(study, folder.segments_of(study), address)


def create(folder: StudyFolder, client: ProlificClient, address: str) -> tuple[ProlificStudy, bool]:
    """Make the draft on Prolific, unless there is one.

    Returns
    -------
    study : ProlificStudy
    made : bool
        Whether it was not there before.
    """
    draft = draft_of(folder, address)
    made = read_made_there(folder.root)
    identity = made.prolific_study
    if identity is None:
        # An earlier try may have come through although its answer did not.
        known = client.study_named(internal_name(folder.study()))
        identity = None if known is None else known.id
    study = client.create(draft) if identity is None else client.study(identity)
    codes = {each.code: each.code_type for each in study.completion_codes}
    noted = {"prolific_study": study.id, "prolific_codes": codes or made.prolific_codes}
    write_made_there(folder.root, made.model_copy(update=noted))
    return study, identity is None


def study_id(folder: StudyFolder) -> str:
    """Return Prolific's id of the study.

    Raises
    ------
    InputError
        If none was made.
    """
    made = read_made_there(folder.root).prolific_study
    if made is None:
        raise InputError(
            "the study is not on Prolific yet",
            where=folder.root,
            remedy="Make a draft with 'motionjury recruit STUDY create'",
        )
    return made


def status(folder: StudyFolder, client: ProlificClient) -> ProlificStatus:
    """Return how the study goes, there and here."""
    identity = study_id(folder)
    codes = folder.study().recruitment.prolific
    people = arrived_in(folder)
    submissions = client.submissions(identity)
    known = by_submission(people, [(each.id, each.participant) for each in submissions])
    judged = tuple(
        JudgedSubmission(
            submission=each,
            ours=ours,
            judged=judge_submission(each.status, each.code, ours, codes),
        )
        for each in submissions
        for ours in [known[each.id].ours]
    )
    there = {each.participant for each in submissions}
    return ProlificStatus(
        study=client.study(identity),
        submissions=judged,
        there_and_here=dict(Counter((each.submission.status, each.ours) for each in judged)),
        missing_there=tuple(
            dict.fromkeys(each.participant for each in people if each.participant not in there)
        ),
    )


def approve(client: ProlificClient, found: ProlificStatus, also: Sequence[str] = ()) -> int:
    """Pay everybody whom the payment rule pays, and those of `also`; return how many.

    Parameters
    ----------
    also : sequence of str
        Submissions that the researcher decided to pay.

    Raises
    ------
    InputError
        If one of `also` is none of the study's submissions; nobody is paid then.
    """
    known = {each.submission.id for each in found.submissions}
    if unknown := sorted(set(also) - known):
        raise InputError(
            f"the study has no submission {listed(unknown)}",
            where="--also",
            remedy="Take their names from the table that this command shows",
        )
    paid = [each.submission.id for each in found.submissions if each.judged.verdict == "pay"]
    paid = list(dict.fromkeys([*paid, *also]))
    client.approve(paid)
    return len(paid)
