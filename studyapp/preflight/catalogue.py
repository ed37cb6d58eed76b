"""All that can be found, by where it is looked for: for the table of `docs/check.md`.

``python -m studyapp.preflight.catalogue --write docs`` puts the table there, and the schema
of what `motionjury check --json` prints beside it.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import MappingProxyType, ModuleType
from typing import Final

from motion.files import write_text
from studyapp.preflight import (
    address_checks,
    balance_checks,
    catch_checks,
    check,
    design_checks,
    finished_video_checks,
    motion_checks,
    page_checks,
    page_weight,
    pay_checks,
    recruiting_checks,
    serving_checks,
    shown_video_checks,
    sound_checks,
    time_checks,
)
from studyapp.preflight.finding import FindingKind
from studyapp.preflight.report import CheckRecord

BEGIN, END = "<!-- findings: begin -->", "<!-- findings: end -->"

ROOMS: Final[Mapping[str, tuple[ModuleType, ...]]] = MappingProxyType(
    {
        "The files": (check,),
        "What participants are told": (page_checks, time_checks),
        "Recruiting and pay": (recruiting_checks, pay_checks),
        "The design": (design_checks, balance_checks),
        "Motion": (motion_checks, catch_checks),
        "Videos": (finished_video_checks, shown_video_checks, page_weight),
        "Sound": (sound_checks,),
        "Serving": (serving_checks, address_checks),
    }
)
"""Where each kind of finding is made; a module states its own."""


def kinds() -> Mapping[str, tuple[FindingKind, ...]]:
    """Return every kind of finding under the room it belongs to, each once."""
    found: dict[str, FindingKind] = {}
    rooms: dict[str, tuple[FindingKind, ...]] = {}
    for room, modules in ROOMS.items():
        own = {
            value.name: value
            for module in modules
            for value in vars(module).values()
            if isinstance(value, FindingKind) and value.name not in found
        }
        rooms[room] = tuple(own.values())
        found |= own
    return rooms


def table() -> Iterator[str]:
    """Yield the lines of the table of all findings, as Markdown."""
    yield "| finding | severity | what it means | what to do |"
    yield "|---|---|---|---|"
    for room, own in kinds().items():
        yield f"| **{room}** | | | |"
        for kind in own:
            cells = (f"`{kind.name}`", kind.severity.value, kind.means, kind.remedy or "–")
            yield f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"


def with_table(page: str) -> str:
    """Return `page` with the table between its marks.

    Raises
    ------
    ValueError
        If it has no such marks.
    """
    before, begin, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not (begin and end):
        raise ValueError(f"there is no place between {BEGIN} and {END}")
    return f"{before}{BEGIN}\n{chr(10).join(table())}\n{END}{after}"


def schema() -> str:
    """Return the JSON schema of what `motionjury check --json` prints."""
    return f"{json.dumps(CheckRecord.model_json_schema(), indent=1)}\n"


def main() -> None:
    """Print the table, or put it and the schema into the folder of documents."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", type=Path, metavar="FOLDER", help="with a check.md")
    documents = parser.parse_args().write
    if documents is None:
        print("\n".join(table()))
        return
    page = documents / "check.md"
    write_text(page, with_table(page.read_text(encoding="utf-8")))
    write_text(documents / "check.schema.json", schema())


if __name__ == "__main__":
    main()
