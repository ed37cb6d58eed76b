"""What a corpus says of itself in ``corpus.json``: how it was made."""

from __future__ import annotations

import json
from dataclasses import asdict, fields
from pathlib import Path
from typing import Final

from pydantic import TypeAdapter, ValidationError

from motion.errors import InputError
from motion.files import write_text
from motion.speech.synthesis import synthesiser_version
from training.corpus.process import VERSION
from training.corpus.request import CorpusRequest

DESCRIPTION: Final = "corpus.json"

_SHARED: Final = "shared_passages"
"""Said only where it is so."""


def claim(folder: Path, request: CorpusRequest) -> None:
    """Say in a folder which corpus it holds.

    Raises
    ------
    InputError
        If it holds another one, or something else.
    """
    wanted = json.dumps(_description(request), indent=2) + "\n"
    path = folder / DESCRIPTION
    if path.exists():
        if path.read_text(encoding="utf-8") != wanted:
            raise InputError(
                "the folder holds another corpus: of other numbers, or made with another version "
                "of the process or of the synthesiser",
                where=path,
                remedy="Name another folder, or remove this one",
            )
        return
    if folder.exists() and any(folder.iterdir()):
        raise InputError(
            "the folder is not empty, and holds no corpus",
            where=folder,
            remedy="Name a folder that is empty or does not exist",
        )
    write_text(path, wanted)


def read_request(folder: Path) -> CorpusRequest:
    """Return which corpus a folder holds.

    Raises
    ------
    InputError
        If it holds none, or one of another version of the process, whose truth cannot be computed.
    """
    path = folder / DESCRIPTION
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        version = content["process_version"]
        asked = {
            field.name: content[field.name]
            for field in fields(CorpusRequest)
            if field.name in content or field.name != _SHARED
        }
        request = TypeAdapter(CorpusRequest).validate_python(asked)
    except (OSError, ValueError, KeyError, TypeError, ValidationError) as error:
        raise InputError(
            "the folder holds no synthetic corpus",
            where=path,
            remedy="Give a folder that 'motionjury corpus' made",
        ) from error
    if version != VERSION:
        raise InputError(
            f"the corpus was made by version {version} of the process, this is version {VERSION}",
            where=path,
            remedy="Make the corpus again",
        )
    return request


def _description(request: CorpusRequest) -> dict[str, object]:
    return {
        "corpus": "synthetic speech and motion with known truth, in the files and folders of BEAT",
        "process_version": VERSION,
        "speech": synthesiser_version(),
        **{key: value for key, value in asdict(request).items() if value or key != _SHARED},
    }
