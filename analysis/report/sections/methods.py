"""Methods text to paste into a paper, made from what was really done."""

from __future__ import annotations

import platform
from importlib import metadata
from types import MappingProxyType
from typing import Final

from analysis.report import wording
from analysis.report.content import Section
from analysis.report.sections.looks import looks_sentence
from analysis.report.sections.verdicts import SIGNIFICANCE, verdicts
from analysis.report.subject import Subject
from analysis.results.pairwise import PairwiseResults
from analysis.results.preference import FEWEST
from analysis.results.report import TableReport
from analysis.stats.clustered_mean import LEVEL
from motion.listing import listed

_CLUSTERED: Final = (
    "intervals are two-way cluster-robust (participants and segments; Cameron, Gelbach and Miller "
    "2011) with the small-sample correction CR2 and Satterthwaite degrees of freedom (Bell and "
    "McCaffrey 2002), never narrower than one-way ones, and not corrected for multiplicity"
)

_MODEL: Final = (
    "cumulative link mixed model (logit, flexible thresholds, Laplace approximation) of the answer "
    "as given, from left to right, with the side on which the {subject} was shown as covariate "
    "(±1) and its effect varying between participants and between segments"
)

_FEW: Final = (
    f"with fewer than {FEWEST} participants or segments, where it finds too much, or where the "
    "model cannot be fitted, those of the win share decide, and where all answers agree, an exact "
    "sign test of participants."
)

_STRENGTHS: Final = (
    f"clustered by participant and segment) hold for all conditions together at {LEVEL:.0%} "
    "(Bonferroni); differences of two are tested by their two-way errors (CR2, Satterthwaite), "
    "and all together by a Wald test (Hotelling's T²). Where a condition never lost, the fit is "
    "penalised by half a win and half a loss of each against an average one (Turner and others "
    "2020), and an exact sign test of participants decides."
)

TESTS: Final = MappingProxyType(
    {
        "pairwise": (
            "Preferences were analysed as win shares (wins plus half the ties; " + _CLUSTERED + ") "
            "and in a " + _MODEL.format(subject="first condition") + "; p values are those of its "
            "likelihood ratio, so that side bias is taken out and ties stay the middle answer; "
            + _FEW
            + " Strengths over all comparisons are those of a Bradley–Terry model with Davidson's "
            "ties and a left-side term; rank intervals (" + _STRENGTHS
        ),
        "mismatch": (
            "Preferences for a motion with its own speech over the same motion with another "
            "segment's speech were analysed as win shares (wins plus half the ties; "
            + _CLUSTERED
            + ") and in a "
            + _MODEL.format(subject="own speech")
            + "; p values are those of its likelihood ratio; "
            + _FEW
        ),
        "rating": (
            "Ratings are described by means (" + _CLUSTERED + "). Conditions were contrasted two "
            "by two in the mean difference of paired ratings, clustered likewise, which decides, "
            "and in a cumulative link mixed model (logit, flexible thresholds, Laplace "
            "approximation) with crossed random intercepts of participants and segments, which "
            "describes and does not test; Cliff's δ stands beside as a measure of size."
        ),
        "ranking": (
            "Rankings are described by mean ranks and shares of first places (" + _CLUSTERED + "), "
            "and by Plackett–Luce worths with ties, which decide; rank intervals (" + _STRENGTHS
        ),
    }
)
"""What was computed, by protocol."""

ANCHOR: Final = "methods"
"""Of the section, by which other parts find it."""

_LIBRARIES: Final = ("numpy", "scipy", "pandas", "matplotlib")


def methods_section(report: TableReport, subject: Subject) -> Section:
    """Return the methods text, and what else a reader must know of settings."""
    answered = subject.origin != "none"
    paragraphs = [_asked(report, subject)]
    if answered:
        paragraphs += [
            _people(report, subject),
            _rules(report),
            TESTS[report.protocol],
            *_family(report),
            *_margin(report),
            *filter(None, (looks_sentence(report),)),
        ]
    return Section(
        anchor=ANCHOR,
        heading="Methods, ready to paste",
        paragraphs=(*paragraphs, _software(report, subject)),
        bullets=(*_questions(subject), *subject.notes, *report.notes),
    )


def _asked(report: TableReport, subject: Subject) -> str:
    asked = {
        "pairwise": "compared two motions of the same speech",
        "rating": "rated motions of the same speech, shown together",
        "ranking": "put motions of the same speech in order",
        "mismatch": "compared one motion with its own speech and with another's",
    }[report.protocol]
    verb = "will have" if subject.origin == "none" else ""
    heard = ""
    if subject.excerpts:
        speakers = {one.speaker for one in subject.excerpts.values() if one.speaker}
        emotions = {one.emotion for one in subject.excerpts.values() if one.emotion}
        seconds = [one.seconds for one in subject.excerpts.values() if one.seconds is not None]
        parts = [
            *([wording.count(len(speakers), "speaker")] if speakers else []),
            *([wording.count(len(emotions), "emotion")] if emotions else []),
            *([f"{wording.quantity(sum(seconds))} s in all"] if seconds else []),
        ]
        heard = f" {wording.count(len(subject.excerpts), 'segment')} of speech were used"
        heard = heard.replace("1 segment of speech were", "1 segment of speech was")
        heard += f" ({', '.join(parts)})." if parts else "."
    frozen = ""
    if subject.frozen:
        held = listed([wording.name(channel) for channel in subject.frozen])
        frozen = f" The videos held {held} still."
    conditions = listed([wording.name(name) for name in subject.conditions])
    return (
        f"{subject.people.capitalize()} {verb} {asked}. ".replace("  ", " ")
        + f"Conditions: {conditions or 'none'}."
        + heard
        + frozen
    )


def _people(report: TableReport, subject: Subject) -> str:
    people = report.participants
    return (
        f"Of {wording.count(people.recruited, subject.people[:-1])} who answered, "
        f"{people.attentive} were analysed. Practice trials were dropped; practice trials shown "
        "again at the end were analysed like all others."
    )


def _rules(report: TableReport) -> str:
    if not report.rules:
        return "No rule of exclusion was applied."
    rules = [
        f"{rule.description} ({rule.removed}{', exploratory' if rule.exploratory else ''})"
        for rule in report.rules
    ]
    return (
        "Participants were excluded, in this order, who were or did one of the following (number "
        f"removed): {'; '.join(rules)}."
    )


def _family(report: TableReport) -> tuple[str, ...]:
    found = verdicts(report)
    count = sum(one.outcome != "outside" for one in found)
    if not count:
        return ()
    declared = report.settings.family
    which = "everything compared, on every question"
    if declared == "by question":
        which = "everything compared, those of each question by themselves"
    elif declared != "all":
        which = f"the declared family “{declared}”; other tests are described and do not decide"
    strengths = (
        " More than three conditions were compared, so that differences of strengths decide."
        if isinstance(report.results, PairwiseResults) and report.results.decided_by == "strengths"
        else ""
    )
    return (
        f"All tests are two-sided.{strengths} p values were corrected by Holm's method over "
        f"{wording.count(count, 'test')}: {which}; a test that could not be made counts as one. "
        f"Corrected values below {SIGNIFICANCE:g} decide.",
    )


def _margin(report: TableReport) -> tuple[str, ...]:
    if report.settings.margin is None:
        return ()
    return (
        "Equivalence was tested by two one-sided tests against a margin of "
        f"{report.settings.margin:g}.",
    )


def _questions(subject: Subject) -> tuple[str, ...]:
    return tuple(
        f"{wording.heading(name)}: “{text.replace('{emotion}', '[emotion]')}”"
        for name, text in subject.questions.items()
        if text
    )


def _software(report: TableReport, subject: Subject) -> str:
    versions = ", ".join(f"{name} {metadata.version(name)}" for name in _LIBRARIES)
    study = f" of the study with SHA-256 {subject.study_sha256}" if subject.study_sha256 else ""
    seed = f", seed {subject.seed}" if subject.seed is not None else ""
    return (
        f"Computed with Motion Jury {report.source.motionjury} (Python "
        f"{platform.python_version()}, {versions}) from answers with SHA-256 "
        f"{report.source.sha256}{study}{seed}."
    )
