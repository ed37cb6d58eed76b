"""The simulated studies' table as a document with one section per kind of study."""

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from benchmarks.validity.conclusions.conclusion import EFFECT
from benchmarks.validity.experiments import EXPERIMENTS
from benchmarks.validity.realised import (
    CONSERVATIVE,
    LEAST_COVERED,
    MOST_FALSE,
    Row,
    Share,
    overall,
)
from motion.files import write_text
from tools.markdown import table

HEAD: Final = f"""# What the report's numbers are worth

`make bench-validity` simulates studies with known truth. It counts how often each number of the
report finds an effect where there is none (*false +*, nominally .05), how often its 95% interval
contains the truth (*covered*), and how often it finds an effect of {EFFECT:g} logits (*power*).
*None* is the share of studies without such a number. ± is one Monte-Carlo standard error. Sizes are
participants × segments; SDs are standard deviations of the preference between participants and
between segments, in logits.

A number is a **headline** if false positives are at most {MOST_FALSE:g} and coverage is at least
{LEAST_COVERED:g}; *within error* if it misses by less than two standard errors. With false
positives below {CONSERVATIVE:g} it is called conservative. Equivalence is simulated with conditions
that differ by exactly the margin, so finding them equivalent is the false positive. The effect of
heterogeneity is that every second emotion is liked more by that amount, and every other one less.
Ranks are right if those of all conditions are. *Verdicts, other processes* are the report's
decisions if answers arise otherwise than in a rehearsal: heavy-tailed tastes, a taste of each
participant for each item, tastes that drift, a third of all answers from one participant, or a
leaderboard of three answers each; any difference found where there is none counts once. No study
has a side bias, so the power of the left side's share is also a share of false positives.
"""

_COLUMNS: Final = ("number", "people × segments, SDs", "false +", "covered", "power", "none")


def write_section(path: Path, name: str, section: str) -> None:
    """Put the section of one kind of study into the document, and keep all others.

    Parameters
    ----------
    path : Path
        The document, created if missing.
    name : str
        Name of the kind of study.
    section : str
        Its results.
    """
    text = path.read_text("utf-8") if path.exists() else ""
    sections = {
        part.split("\n", 1)[0]: f"## {part.rstrip()}\n"
        for part in re.split(r"^## ", text, flags=re.MULTILINE)[1:]
    }
    sections[_heading(name)] = section
    write_text(path, document(sections))


def document(sections: Mapping[str, str]) -> str:
    """Return the document of sections by heading, with a list of missing kinds of studies."""
    names = [experiment.name for experiment in EXPERIMENTS]
    missing = [name for name in names if _heading(name) not in sections]
    outcome = [sections[_heading(name)] for name in names if name not in missing]
    gap = f"Not here yet: {'; '.join(missing)}.\n"
    return "\n".join([HEAD, *([gap] if missing else []), *outcome])


def _heading(name: str) -> str:
    return name[0].upper() + name[1:]


def section(name: str, rows: Sequence[Row], *, studies: int, seed: int) -> str:
    """Return the results of one kind of study, in Markdown.

    `studies` is the number of simulated studies per design and effect, `seed` their seed.
    """
    numbers: dict[str, list[Row]] = {}
    for row in rows:
        numbers.setdefault(row.number, []).append(row)
    cells: list[Sequence[str]] = []
    for number, measured_rows in numbers.items():
        naive = " (as papers do)" if measured_rows[0].naive else ""
        verdict = overall(measured_rows).replace(" x ", " × ")
        cells.append((f"**{number}**{naive}", "", "", "", "", "", f"**{verdict}**"))
        cells += map(_cells, measured_rows)
    facts = f"{studies:,} studies of each size without and with an effect, seed {seed}."
    return f"## {_heading(name)}\n\n{facts}\n\n{table((*_COLUMNS, 'verdict'), cells)}\n"


def _cells(row: Row) -> Sequence[str]:
    outcome = row.realised
    shares = (outcome.false_positives, outcome.coverage, outcome.power)
    size = row.size.replace(" x ", " × ")
    return ("", size, *map(_share, shares), f"{outcome.silent:.2f}", outcome.verdict)


def _share(share: Share) -> str:
    return "–" if math.isnan(share.value) else f"{share.value:.3f} ± {share.error:.3f}"
