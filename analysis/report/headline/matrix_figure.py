"""Win shares of every condition against every other one, as a matrix."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import matplotlib as mpl
from matplotlib.patches import Rectangle

from analysis.report import wording
from analysis.report.content import Picture
from analysis.report.headline.panels import (
    LABEL_SIZE,
    LABELS,
    SMALL_SIZE,
    TALLEST,
    TITLE_SIZE,
    numbered,
)
from analysis.report.ink import PAPER, STYLE, between_sides, on
from analysis.report.sheet import Sheet, fitted
from analysis.report.svg import WIDTH, picture

_LARGEST_CELL: Final = 0.5
_HEAD: Final = 0.42
_BELOW: Final = 0.16


@dataclass(frozen=True, kw_only=True)
class Won:
    """A win share against one condition, in words, and whether its test decides."""

    share: float
    words: str
    decided: bool


def matrix_pictures(
    questions: Mapping[str, Mapping[tuple[str, str], Won]],
    conditions: Sequence[str],
    *,
    name: str,
    title: str,
    caption: str,
    data: str,
    mark: str,
) -> tuple[Picture, ...]:
    """Draw a matrix per question: the share of the row's condition against the column's.

    Parameters
    ----------
    questions : mapping of str to mapping of (str, str) to Won
        By question, and then by the condition that wins and the one it wins against.
    conditions : sequence of str
        Rows and columns, in order; columns are numbered as the rows are.
    name, title, caption, data
        See `analysis.report.svg.picture`.
    mark : str
        Written on top; empty for none.
    """
    count = len(conditions)
    cell = min(_LARGEST_CELL, (WIDTH - LABELS) / count)
    columns = max(1, min(2, len(questions), int((WIDTH - LABELS + 0.3) // (cell * count + 0.3))))
    line = _HEAD + cell * count + _BELOW
    per_sheet = max(1, int(TALLEST // line)) * columns
    asked = list(questions)
    pages = [asked[start : start + per_sheet] for start in range(0, len(asked), per_sheet)]
    found = []
    for page, own_name in zip(pages, numbered(name, len(pages)), strict=True):
        hints: dict[str, str] = {}
        with mpl.rc_context(STYLE):
            sheet = Sheet(line * -(-len(page) // columns), mark=mark)
            for number, question in enumerate(page):
                row, column = divmod(number, columns)
                left = LABELS + column * (cell * count + 0.3)
                hints |= _matrix(
                    sheet, question, questions[question], conditions, left, row * line, cell
                )
            found.append(
                picture(
                    sheet.figure,
                    name=own_name,
                    title=title,
                    alt=_alt({q: questions[q] for q in page}, conditions),
                    caption=caption,
                    data=data,
                    hints=hints,
                )
            )
    return tuple(found)


def _matrix(
    sheet: Sheet,
    question: str,
    shares: Mapping[tuple[str, str], Won],
    conditions: Sequence[str],
    left: float,
    top: float,
    cell: float,
) -> dict[str, str]:
    count = len(conditions)
    room = fitted(wording.heading(question), cell * count, size=TITLE_SIZE, bold=True)
    sheet.write(left, top + 0.12, room, fontsize=TITLE_SIZE, fontweight="bold", va="baseline")
    axes = sheet.panel(left, top + _HEAD, cell * count, cell * count)
    axes.set_axis_off()
    axes.set_xlim(0, count)
    axes.set_ylim(count, 0)
    hints: dict[str, str] = {}
    for row, one in enumerate(conditions):
        middle = top + _HEAD + (row + 0.5) * cell
        if left == LABELS:
            name = fitted(f"{wording.name(one)}", LABELS - 0.35, size=LABEL_SIZE, lines=3)
            sheet.write(LABELS - 0.3, middle, name, ha="right", va="center", fontsize=LABEL_SIZE)
            sheet.write(
                LABELS - 0.08, middle, f"{row + 1}", ha="right", va="center", fontsize=LABEL_SIZE
            )
        sheet.write(
            left + (row + 0.5) * cell,
            top + _HEAD - 0.05,
            f"{row + 1}",
            ha="center",
            va="baseline",
            fontsize=LABEL_SIZE,
        )
        for column, other in enumerate(conditions):
            won = shares.get((one, other))
            if won is None:
                if one == other:
                    axes.text(column + 0.5, row + 0.5, "–", ha="center", va="center", fontsize=8)
                continue
            colour = between_sides(1 - won.share)
            gid = f"cell-{asked_name(question)}-{row}-{column}"
            axes.add_patch(
                Rectangle((column, row), 1, 1, facecolor=colour, edgecolor=PAPER, gid=gid)
            )
            hints[gid] = f"{wording.name(one)} against {wording.name(other)}: {won.words}"
            axes.text(
                column + 0.5,
                row + 0.5,
                wording.share(won.share),
                ha="center",
                va="center_baseline",
                fontsize=LABEL_SIZE if cell > 0.4 else SMALL_SIZE,
                fontweight="bold" if won.decided else "normal",
                color=on(colour),
            )
    return hints


def asked_name(question: str) -> str:
    """Return a question's name as a part of an id."""
    return "".join(
        sign if sign.isascii() and sign.isalnum() else f"u{ord(sign)}" for sign in question
    )


def _alt(questions: Mapping[str, Mapping[tuple[str, str], Won]], conditions: Sequence[str]) -> str:
    place = {name: number for number, name in enumerate(conditions)}
    return "; ".join(
        f"{wording.name(question)}, {wording.name(one)} against {wording.name(other)}: {won.words}"
        for question, shares in questions.items()
        for (one, other), won in shares.items()
        if place[one] < place[other]
    )
