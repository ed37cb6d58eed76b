"""Reading `study.toml`: its protocol, and everything that is wrong with it."""

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from pydantic import ValidationError

from motion.errors import InputError
from studyapp.study.protocols.mismatch import MismatchStudy
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.protocols.ranking import RankingStudy
from studyapp.study.protocols.rating import RatingStudy
from studyapp.study.settings.sections import explain_errors, lines_of, with_line
from studyapp.study.settings.study import Study

PROTOCOLS: Final[Mapping[str, type[Study]]] = {
    "pairwise": PairwiseStudy,
    "rating": RatingStudy,
    "ranking": RankingStudy,
    "mismatch": MismatchStudy,
}
"""All protocols by name."""

ALIASES: Final[Mapping[str, str]] = {"amuse": "pairwise", "s2ue": "rating", "diffsheg": "ranking"}
"""The papers whose studies the protocols follow."""


def read_study(path: Path) -> Study:
    """Read and validate a `study.toml`.

    Raises
    ------
    InputError
        If it is not valid; every wrong key is named.
    """
    return parse_text(read_text(path), where=path)


def read_text(path: Path) -> str:
    """Return the text of a study file, or raise `InputError`."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InputError(
            "there is no such study file",
            where=path,
            remedy="Create a study with 'motionjury init FOLDER', or check the folder's name",
        ) from None
    except UnicodeDecodeError as error:
        raise InputError(
            f"the file is not UTF-8 text (byte {error.start})",
            where=path,
            remedy="Save it as UTF-8",
        ) from None


def parse_text(text: str, *, where: object) -> Study:
    """Validate the text of a study file; `InputError` names every wrong key."""
    try:
        data = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(
            f"this is not valid TOML: {error}", where=where, remedy="Fix that line"
        ) from None
    return parse_study(data, where=where, text=text)


def parse_study(data: Mapping[str, object], *, where: object, text: str = "") -> Study:
    """Validate the contents of a study file; `InputError` names every wrong key.

    Parameters
    ----------
    text : str
        The file's text, if errors should name lines.
    """
    name = data.get("protocol", "pairwise")
    protocol = ALIASES.get(str(name), str(name))
    if protocol not in PROTOCOLS:
        raise InputError(
            with_line(f"protocol: unknown protocol {name!r}", lines_of(text)),
            where=where,
            remedy=f"Use one of {', '.join((*PROTOCOLS, *ALIASES))}",
        )
    try:
        return PROTOCOLS[protocol].model_validate({**data, "protocol": protocol})
    except ValidationError as error:
        raise InputError(
            explain_errors(error, PROTOCOLS[protocol], text),
            where=where,
            remedy="Correct these keys",
        ) from None
