"""``python -m tools.check_page`` puts the table of findings, and a schema, into `docs`.

The table of `docs/check.md` is `studyapp/preflight/findings.toml`; beside it lies the schema of
what `motionjury check --json` prints.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from motion.files import write_text
from studyapp.preflight.finding import CheckRecord, catalogue

DOCS: Final = Path(__file__).resolve().parents[1] / "docs"
BEGIN, END = "<!-- findings: begin -->", "<!-- findings: end -->"


def table() -> Iterator[str]:
    """Yield the lines of the table of all findings, as Markdown."""
    yield "| finding | severity | what it means | what to do |"
    yield "|---|---|---|---|"
    for place, kinds in catalogue().items():
        yield f"| **{place}** | | | |"
        for name, kind in kinds.items():
            cells = (f"`{name}`", kind.severity, kind.means, kind.remedy or "–")
            yield f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"


def with_table(page: str) -> str:
    """Return `page` with the table between its marks."""
    before, _, rest = page.partition(BEGIN)
    _, _, after = rest.partition(END)
    return f"{before}{BEGIN}\n{chr(10).join(table())}\n{END}{after}"


def schema() -> str:
    """Return the JSON schema of what `motionjury check --json` prints."""
    return f"{json.dumps(CheckRecord.model_json_schema(), indent=1)}\n"


def main() -> None:
    """Write both."""
    page = DOCS / "check.md"
    write_text(page, with_table(page.read_text(encoding="utf-8")))
    write_text(DOCS / "check.schema.json", schema())


if __name__ == "__main__":
    main()
