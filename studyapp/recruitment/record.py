"""What a study has on recruiters' sites, and the completion codes that it shares with them.

The record of what was made there is kept beside the study, in ``recruitment.json``.
"""

from pathlib import Path
from typing import Final

from pydantic import BaseModel, ConfigDict, ValidationError

from motion.errors import InputError
from motion.files import write_text
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.recruitment import draw_code
from studyapp.study.settings.study import Study

FILE: Final = "recruitment.json"


class RecruitmentRecord(BaseModel):
    """What was made for a study on recruiters' sites.

    Attributes
    ----------
    prolific_study : str or None
        Prolific's id of the study.
    prolific_codes : mapping of str to str
        The completion codes that Prolific knows, each with its type there.
    sandbox_hits, live_hits : tuple of str
        Mechanical Turk's ids of the HITs, in the order they were made.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    prolific_study: str | None = None
    prolific_codes: dict[str, str] = {}
    sandbox_hits: tuple[str, ...] = ()
    live_hits: tuple[str, ...] = ()


def read_record(root: Path) -> RecruitmentRecord:
    """Return the record of the study in `root`; an empty one without a file."""
    path = root / FILE
    try:
        return RecruitmentRecord.model_validate_json(path.read_text("utf-8"))
    except FileNotFoundError:
        return RecruitmentRecord()
    except (ValidationError, UnicodeDecodeError):
        raise InputError(
            "the file does not say what was made at recruiters' sites",
            where=path,
            remedy="Bring it back from a backup, or write the id of the study on Prolific into it: "
            '{"prolific_study": "…"}',
        ) from None


def write_record(root: Path, record: RecruitmentRecord) -> None:
    """Write the record of the study in `root`."""
    write_text(root / FILE, record.model_dump_json(indent=2) + "\n")


KEYS: Final = ("completed", "screened_out", "failed_attention")


def draw_codes(folder: StudyFolder) -> dict[str, str]:
    """Return new completion codes by their key in ``[recruitment.prolific]``.

    Raises
    ------
    InputError
        If the study is on Prolific already, which only knows the codes that it was made with.
    """
    prolific_study = read_record(folder.root).prolific_study
    if prolific_study is not None:
        raise InputError(
            f"the study is on Prolific already ({prolific_study}), which only knows its present "
            "codes: participants who return with another one would not be paid",
            where=folder.root / FILE,
            remedy="Keep the codes. For new ones, delete the draft on Prolific, remove its id from "
            "this file, draw them, and run 'motionjury recruit STUDY create' again",
        )
    return {key: draw_code() for key in KEYS}


def count_places(study: Study) -> int:
    """Return how many participants the study has places for."""
    return sum(arm.places for arm in study.arms)


def require_public(address: str) -> None:
    """Raise `InputError` unless `address` is one that recruiters accept."""
    if not address.startswith("https://") or "?" in address or "#" in address:
        raise InputError(
            "this is not an address that a recruiter accepts",
            where=address,
            remedy="Give the one at which the whole internet reaches the study, with https://",
        )
