"""``make pages`` writes the table of findings, and a schema, into `docs`.

The table in `docs/check.md` comes from `studyapp/preflight/findings.toml`; the schema describes
what `motionjury check --record` writes.
"""

import json
from pathlib import Path
from typing import Final

from motion.files import write_text
from studyapp.preflight.finding import CheckRecord, catalogue
from tools.markdown import table, with_part

DOCS: Final = Path(__file__).resolve().parents[2] / "docs"


def with_table(page: str) -> str:
    """Return `page` with the table of all findings between its marks."""
    rows: list[tuple[str, ...]] = []
    for place, kinds in catalogue().items():
        rows.append((f"**{place}**", "", "", ""))
        for name, kind in kinds.items():
            cells = (f"`{name}`", kind.severity, kind.means, kind.remedy or "–")
            rows.append(tuple(cell.replace("|", "\\|") for cell in cells))
    head = ("finding", "severity", "what it means", "what to do")
    return with_part(page, "findings", table(head, rows))


def schema() -> str:
    """Return the JSON schema of what `motionjury check --record` writes."""
    return f"{json.dumps(CheckRecord.model_json_schema(), indent=1)}\n"


def main() -> None:
    """Write the table and the schema."""
    page = DOCS / "check.md"
    write_text(page, with_table(page.read_text(encoding="utf-8")))
    write_text(DOCS / "check.schema.json", schema())


if __name__ == "__main__":
    main()
