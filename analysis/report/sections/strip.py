"""The section that shows the conditions themselves: stills at the same moments of one speech."""

from __future__ import annotations

from markupsafe import Markup

from analysis.report import wording
from analysis.report.content import Picture, Section
from analysis.report.subject import Still, Subject
from motion.errors import listed

ANCHOR = "stills"
HEADING = "What the conditions look like"


def strip_section(subject: Subject) -> Section | None:
    """Return a row of stills for each condition; None where there cannot be any."""
    if not subject.stills:
        if not subject.no_stills:
            return None
        return Section(anchor=ANCHOR, heading=HEADING, paragraphs=(subject.no_stills,))
    segment = subject.stills[0].segment
    rows: dict[str, list[Still]] = {}
    for still in subject.stills:
        rows.setdefault(still.condition, []).append(still)
    missing = [name for name in subject.conditions if name not in rows]
    excerpt = subject.excerpts.get(segment)
    said = f" It says: “{excerpt.transcript}”" if excerpt and excerpt.transcript else ""
    paragraphs = [
        f"Frames of the videos that were shown, of segment {wording.name(segment)}, at loud "
        f"syllables: gestures fall on these. A still tells nothing of how a motion moves.{said}"
    ]
    if missing:
        names = listed([wording.condition(name) for name in missing])
        paragraphs.append(
            f"There is no video of this segment, or none that can be read, of {names}."
        )
    return Section(
        anchor=ANCHOR,
        heading=HEADING,
        paragraphs=tuple(paragraphs),
        pictures=(
            Picture(
                svg=_strip(rows),
                caption=f"Segment {wording.name(segment)}: each row is a condition, each column a "
                "moment in seconds from the beginning.",
            ),
        ),
    )


def _strip(rows: dict[str, list[Still]]) -> Markup:
    """Return the stills as a table of pictures, each with words for those who cannot see it."""
    moments = next(iter(rows.values()))
    head = Markup("").join(
        Markup('<th scope="col">{}</th>').format(_moment(still)) for still in moments
    )
    body = Markup("").join(
        Markup('<tr><th scope="row">{}</th>{}</tr>').format(
            wording.condition(condition), Markup("").join(_cell(still) for still in stills)
        )
        for condition, stills in rows.items()
    )
    return Markup(
        '<table class="stills"><thead><tr><td></td>{}</tr></thead><tbody>{}</tbody></table>'
    ).format(head, body)


def _cell(still: Still) -> Markup:
    said = f", at “{still.word}”" if still.word else ""
    words = f"{wording.condition(still.condition)} after {still.seconds:.1f} seconds{said}"
    return Markup('<td><img src="{}" alt="{}"></td>').format(still.image, words)


def _moment(still: Still) -> str:
    return f"{still.seconds:.1f} s" + (f" “{still.word}”" if still.word else "")
