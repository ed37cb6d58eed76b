"""What was made at recruiters' sites, kept beside the study: ``recruitment.json``."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from pydantic import BaseModel, ConfigDict, ValidationError

from motion.errors import InputError
from motion.files import write_text

FILE: Final = "recruitment.json"


class MadeThere(BaseModel):
    """What was made.

    Attributes
    ----------
    prolific_study : str or None
        Prolific's id of the study.
    prolific_codes : mapping of str to str
        The completion codes that Prolific knows, each with what it stands for there.
    sandbox_hits, live_hits : tuple of str
        Mechanical Turk's ids of the HITs, in the order they were made.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    prolific_study: str | None = None
    prolific_codes: dict[str, str] = {}
    sandbox_hits: tuple[str, ...] = ()
    live_hits: tuple[str, ...] = ()


def read_made_there(root: Path) -> MadeThere:
    """Return what was made for the study in `root`; nothing where there is no file."""
    path = root / FILE
    try:
        return MadeThere.model_validate_json(path.read_text("utf-8"))
    except FileNotFoundError:
        return MadeThere()
    except (ValidationError, UnicodeDecodeError):
        raise InputError(
            "the file does not say what was made at recruiters' sites",
            where=path,
            remedy="Bring it back from a backup, or write the id of the study on Prolific into it: "
            '{"prolific_study": "…"}',
        ) from None


def write_made_there(root: Path, made: MadeThere) -> None:
    """Keep what was made for the study in `root`."""
    write_text(root / FILE, made.model_dump_json(indent=2) + "\n")
