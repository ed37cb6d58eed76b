"""What participants are not told before they agree."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from typing import Final, get_args

from motion.listing import listed
from studyapp.preflight.finding import Finding, error, warning
from studyapp.study.creation.template_language import TEMPLATES_IN, still_english, templates
from studyapp.study.settings.page import Language, reaches_somebody
from studyapp.study.settings.study import Study

ORGANISATION_MISSING: Final = warning(
    "organisation-missing",
    "participants are not told who runs the study",
    "Fill in page.organisation in study.toml",
)
CONTACT_MISSING: Final = warning(
    "contact-missing",
    "participants have nobody to ask",
    "Fill in page.contact in study.toml: an e-mail address that somebody reads",
)
CONTACT_UNREACHABLE: Final = warning(
    "contact-unreachable",
    "page.contact holds no address and no telephone number",
    "Say how to reach somebody, as by an e-mail address",
)
PAYMENT_MISSING: Final = warning(
    "payment-missing",
    "participants are not told what they get",
    "Fill in page.payment in study.toml; 'none' is an answer too",
)
MINUTES_MISSING: Final = warning(
    "minutes-missing",
    "participants are not told how long it takes",
    "Fill in page.minutes in study.toml; the finding expected-duration says how long it takes",
)
ETHICS_MISSING: Final = warning(
    "ethics-missing",
    "participants are not told who approved the study",
    "Fill in page.ethics in study.toml: the committee and its number, or that none was needed",
)
CONSENT_BLANK: Final = error(
    "consent-blank",
    "participants would agree to an empty text",
    "Write page.consent in study.toml",
)
CONSENT_FROM_TEMPLATE: Final = warning(
    "consent-from-template",
    "the consent text is still the template's, which knows nothing of your institution's rules",
    "Have page.consent in study.toml say what your ethics committee asks for: purpose, what is "
    "stored and how long, who sees it, rights",
)
TITLE_FROM_TEMPLATE: Final = warning(
    "title-from-template",
    "the study has the template's title",
    "Give it a title of its own in study.toml; participants see it on every page",
)
TEXTS_UNTRANSLATED: Final = warning(
    "texts-untranslated",
    "the pages are in another language than what the study file says",
    "Translate them in study.toml; 'motionjury init --language' shows how they may read",
)


def page_findings(study: Study) -> Iterator[Finding]:
    """Say what participants are not told, and what still says what a template says."""
    page = study.page
    for given, kind, key in (
        (page.organisation, ORGANISATION_MISSING, "page.organisation"),
        (page.contact, CONTACT_MISSING, "page.contact"),
        (page.payment, PAYMENT_MISSING, "page.payment"),
        (page.minutes, MINUTES_MISSING, "page.minutes"),
        (page.ethics, ETHICS_MISSING, "page.ethics"),
    ):
        if not given or not str(given).strip():
            yield kind.found(kind.means, where=key)
    if page.contact.strip() and not reaches_somebody(page.contact):
        yield CONTACT_UNREACHABLE.found(
            f"{page.contact!r} does not say how to reach anybody", where="page.contact"
        )
    yield from _text_findings(study)


def _text_findings(study: Study) -> Iterator[Finding]:
    consents, titles = _template_texts(study)
    if not study.page.consent.strip():
        yield CONSENT_BLANK.found(CONSENT_BLANK.means, where="page.consent")
    elif _squeezed(study.page.consent) in consents:
        yield CONSENT_FROM_TEMPLATE.found(CONSENT_FROM_TEMPLATE.means, where="page.consent")
    if _squeezed(study.title) in titles:
        yield TITLE_FROM_TEMPLATE.found(
            f"{TITLE_FROM_TEMPLATE.means}, {study.title!r}", where="title"
        )
    english = still_english(study)
    if english:
        yield TEXTS_UNTRANSLATED.found(
            f"the pages are in the language {study.page.language!r}, but {listed(english)} still "
            "say what the English template says",
            where="study.toml",
        )


def _template_texts(study: Study) -> tuple[set[str], set[str]]:
    """Return the consent texts and the titles that templates of the protocol have."""
    file = f"{study.protocol}.toml"
    consents, titles = set(), set()
    for language in get_args(Language):
        place = (file,) if language == TEMPLATES_IN else (language, file)
        source = tomllib.loads(templates().joinpath(*place).read_text("utf-8"))
        consents.add(_squeezed(source["page"]["consent"]))
        titles.add(_squeezed(source["title"]))
    return consents, titles


def _squeezed(text: str) -> str:
    """Return a text in which white space says nothing."""
    return " ".join(text.split())
