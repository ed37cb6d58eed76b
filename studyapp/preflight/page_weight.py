"""How much a participant's browser loads, page by page."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from studyapp.preflight.finding import Finding, finding
from studyapp.preflight.material import Material
from studyapp.study.design.planned_trial import PlannedTrial
from studyapp.study.design.stimulus import Content

MEGABYTE: Final = 10**6

PLACES: Final = 24
"""Places of each arm whose trials are planned to find the heaviest page."""


@dataclass(frozen=True, kw_only=True)
class Weight:
    """What is loaded in one study session, in bytes.

    Attributes
    ----------
    heaviest : int
        For the page that loads most: its own videos, and those fetched ahead for the next one.
    total : int
        For all pages together; what was fetched ahead is loaded once.
    """

    heaviest: int
    total: int


def weight_of(plan: Sequence[PlannedTrial], sizes: Mapping[Content, int]) -> Weight:
    """Return what the trials of a study session load.

    Parameters
    ----------
    plan : sequence of PlannedTrial
        The trials in their order.
    sizes : mapping of Content to int
        Bytes of each video; those that are not there count nothing.
    """
    pages = [sum(sizes.get(content, 0) for content in trial.shown) for trial in plan]
    with_next = [here + after for here, after in zip(pages, [*pages[1:], 0], strict=False)]
    return Weight(heaviest=max(with_next, default=0), total=sum(pages))


def weight_findings(material: Material) -> Iterator[Finding]:
    """Say how much participants load, and whether a page loads more than the study allows."""
    sizes = {content: video.file.stat().st_size for content, video in material.shown.items()}
    if not sizes:
        return
    weights = [weight_of(plan, sizes) for _, plans in material.planned for plan in plans[:PLACES]]
    heaviest = max(weight.heaviest for weight in weights)
    total = max(weight.total for weight in weights)
    yield finding(
        "page-weight",
        f"a page loads up to {_megabytes(heaviest)} of videos, its own and those of the next one; "
        f"a participant loads up to {_megabytes(total)} in all",
    )
    allowed = material.study.watching.megabytes_per_page
    if heaviest > allowed * MEGABYTE:
        yield finding(
            "page-heavy",
            f"a page loads up to {_megabytes(heaviest)} of videos, more than the "
            f"{allowed:g} MB that watching.megabytes_per_page allows",
            where="watching.megabytes_per_page",
        )


def _megabytes(size: int) -> str:
    return f"{size / MEGABYTE:.1f} MB"
