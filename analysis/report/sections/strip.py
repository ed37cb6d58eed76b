"""The section that shows the conditions themselves: stills at the same moments of one speech."""

from __future__ import annotations

from itertools import groupby

from markupsafe import Markup

from analysis.report import wording
from analysis.report.content import Picture, Section
from analysis.report.subject import Still, Subject
from analysis.report.texts import paragraphs

ANCHOR = "stills"
HEADING = "What the conditions look like"


def strip_section(subject: Subject) -> Section | None:
    """Return a row of stills for each condition; None where there cannot be any."""
    if not subject.stills:
        said = (subject.no_stills,)
        return Section(anchor=ANCHOR, heading=HEADING, paragraphs=said) if said[0] else None
    segment = subject.stills[0].segment
    rows = {name: list(own) for name, own in groupby(subject.stills, lambda one: one.condition)}
    excerpt = subject.excerpts.get(segment)
    picture = Picture(
        svg=_strip(rows),
        caption=f"Segment {wording.name(segment)}: each row is a condition, each column a moment "
        "in seconds from the beginning.",
    )
    return Section(
        anchor=ANCHOR,
        heading=HEADING,
        paragraphs=paragraphs(
            "participants.stills",
            segment=segment,
            said=excerpt.transcript if excerpt else "",
            missing=[wording.condition(name) for name in subject.conditions if name not in rows],
        ),
        pictures=(picture,),
    )


def _strip(rows: dict[str, list[Still]]) -> Markup:
    """Return the stills as a table of pictures, each with words for those who cannot see it."""
    head = (
        Markup('<th scope="col">{:.1f} s{}</th>').format(
            still.seconds, f" “{still.word}”" if still.word else ""
        )
        for still in next(iter(rows.values()))
    )
    body = (
        Markup('<tr><th scope="row">{}</th>{}</tr>').format(
            wording.condition(name), Markup("").join(map(_cell, stills))
        )
        for name, stills in rows.items()
    )
    return Markup(
        '<table class="stills"><thead><tr><td></td>{}</tr></thead><tbody>{}</tbody></table>'
    ).format(Markup("").join(head), Markup("").join(body))


def _cell(still: Still) -> Markup:
    said = f", at “{still.word}”" if still.word else ""
    words = f"{wording.condition(still.condition)} after {still.seconds:.1f} seconds{said}"
    return Markup('<td><img src="{}" alt="{}"></td>').format(still.image, words)
