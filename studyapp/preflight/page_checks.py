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
    for given, name in (
        (page.organisation, "organisation-missing"),
        (page.contact, "contact-missing"),
        (page.payment, "payment-missing"),
        (page.minutes, "minutes-missing"),
        (page.ethics, "ethics-missing"),
    ):
        if not given or not str(given).strip():
            yield finding(name)
    if page.contact.strip() and not reaches_somebody(page.contact):
        yield finding("contact-unreachable", contact=page.contact)
    yield from _text_findings(study)


def _text_findings(study: Study) -> Iterator[Finding]:
    consents, titles = _template_texts(study)
    if not study.page.consent.strip():
        yield finding("consent-blank")
    elif _squeezed(study.page.consent) in consents:
        yield finding("consent-from-template")
    if _squeezed(study.title) in titles:
        yield finding("title-from-template", title=study.title)
    english = still_english(study)
    if english:
        yield finding("texts-untranslated", language=study.page.language, texts=listed(english))


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
