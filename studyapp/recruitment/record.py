"""What a study and recruiters' sites know of each other: what was made there, and the codes.

What was made is kept beside the study, in ``recruitment.json``.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import tomlkit
from pydantic import BaseModel, ConfigDict, ValidationError

from motion.errors import InputError
from motion.files import write_text
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.reading import parse_text, read_text
from studyapp.study.settings.recruitment import draw_code
from studyapp.study.settings.study import Study

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


KEYS: Final = ("completed", "screened_out", "failed_attention")
HEADING: Final = re.compile(r"^\[recruitment\.prolific\][^\n]*\n", re.MULTILINE)


def draw_codes(folder: StudyFolder, *, again: bool = False) -> list[str]:
    """Write codes into the study file where it has none; all else in it stays as it is.

    Parameters
    ----------
    again : bool
        Whether codes that are there are replaced.

    Returns
    -------
    list of str
        Keys of the codes that were drawn.

    Raises
    ------
    InputError
        If the study file is wrong in another way, or the study is on Prolific already, which
        knows no other codes than those that it was made with.
    """
    text = read_text(folder.definition)
    try:
        written = _prolific(tomllib.loads(text))
        drawn = {key: draw_code() for key in KEYS if again or not written.get(key)}
        if drawn:
            _require_unmade(folder)
        text = _replaced(text, {key: drawn[key] for key in drawn if key in written})
        text = _added(text, {key: drawn[key] for key in drawn if key not in written})
    except tomllib.TOMLDecodeError as error:
        raise InputError(
            f"not valid TOML: {error}", where=folder.definition, remedy="Mend that line"
        ) from None
    parse_text(text, where=folder.definition)
    if drawn:
        write_text(folder.definition, text)
    return list(drawn)


def _require_unmade(folder: StudyFolder) -> None:
    made = read_made_there(folder.root).prolific_study
    if made is not None:
        raise InputError(
            f"the study is on Prolific already ({made}), which knows its present codes alone: who "
            "comes back with another one would not be paid",
            where=folder.root / FILE,
            remedy="Keep the codes. For new ones, delete the draft on Prolific, remove its id from "
            "this file, draw them, and run 'motionjury recruit STUDY create' again",
        )


def _prolific(document: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the table of Prolific's keys; an empty one where there is none."""
    table: Any = document
    for key in ("recruitment", "prolific"):
        table = table.get(key, {}) if isinstance(table, dict) else {}
    return table if isinstance(table, dict) else {}


def _replaced(text: str, codes: Mapping[str, str]) -> str:
    """Return `text` with codes in the place of those that it has."""
    document: Any = tomlkit.parse(text)
    for key, code in codes.items():
        document["recruitment"]["prolific"][key] = code
    return tomlkit.dumps(document) if codes else text


def _added(text: str, codes: Mapping[str, str]) -> str:
    """Return `text` with further codes under the heading of their table, or with both at the end.

    Written as text: tomlkit would set them after the comments that lead over to the next table.
    """
    if not codes:
        return text
    lines = "".join(f'{key} = "{code}"\n' for key, code in codes.items())
    heading = HEADING.search(text)
    if heading is None:
        return f"{text.rstrip()}\n\n[recruitment.prolific]\n{lines}"
    return text[: heading.end()] + lines + text[heading.end() :]


def places_of(study: Study) -> int:
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
