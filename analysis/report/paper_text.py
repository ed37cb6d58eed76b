"""The sentences of a report that go into a paper, as plain text."""

from __future__ import annotations

from analysis.report.content import Page
from analysis.report.sections.methods import ANCHOR


def paper_text(page: Page) -> str:
    """Return the answer, the participant flow and the methods, a paragraph each.

    Whatever must be said on every page, such as that nobody but simulated raters answered, comes
    first.
    """
    methods = [section for section in page.sections if section.anchor == ANCHOR]
    paragraphs = [
        *([page.mark] if page.mark else []),
        " ".join(page.answer),
        page.flow,
        *(text for section in methods for text in (*section.paragraphs, *section.bullets)),
    ]
    return "\n\n".join(paragraph for paragraph in paragraphs if paragraph) + "\n"
