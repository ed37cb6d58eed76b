"""What participants are not told before they agree."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from typing import get_args

from motion.listing import listed
from studyapp.preflight.finding import Finding, finding
from studyapp.study.creation.template_language import still_english, template_text
from studyapp.study.settings.page import Language, reaches_somebody
from studyapp.study.settings.study import Study


def page_findings(study: Study) -> Iterator[Finding]:
    """Say what participants are not told, and what still says what a template says."""
    page = study.page
    for given, name, key in (
        (page.organisation, "organisation-missing", "page.organisation"),
        (page.contact, "contact-missing", "page.contact"),
        (page.payment, "payment-missing", "page.payment"),
        (page.minutes, "minutes-missing", "page.minutes"),
        (page.ethics, "ethics-missing", "page.ethics"),
    ):
        if not given or not str(given).strip():
            yield finding(name, where=key)
    if page.contact.strip() and not reaches_somebody(page.contact):
        yield finding(
            "contact-unreachable",
            f"{page.contact!r} does not say how to reach anybody",
            where="page.contact",
        )
    yield from _text_findings(study)


def _text_findings(study: Study) -> Iterator[Finding]:
    consents, titles = _template_texts(study)
    if not study.page.consent.strip():
        yield finding("consent-blank", where="page.consent")
    elif _squeezed(study.page.consent) in consents:
        yield finding("consent-from-template", where="page.consent")
    if _squeezed(study.title) in titles:
        yield finding(
            "title-from-template",
            f"the study has the template's title, {study.title!r}",
            where="title",
        )
    english = still_english(study)
    if english:
        yield finding(
            "texts-untranslated",
            f"the pages are in the language {study.page.language!r}, but {listed(english)} still "
            "say what the English template says",
            where="study.toml",
        )


def _template_texts(study: Study) -> tuple[set[str], set[str]]:
    """Return the consent texts and the titles that templates of the protocol have."""
    file = f"{study.protocol}.toml"
    consents, titles = set(), set()
    for language in get_args(Language):
        source = tomllib.loads(template_text(file, language))
        consents.add(_squeezed(source["page"]["consent"]))
        titles.add(_squeezed(source["title"]))
    return consents, titles


def _squeezed(text: str) -> str:
    """Return a text in which white space says nothing."""
    return " ".join(text.split())
