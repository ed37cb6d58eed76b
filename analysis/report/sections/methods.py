"""Methods text to paste into a paper, of what was really done, and what may not be concluded."""

from __future__ import annotations

import platform
from importlib import metadata
from types import MappingProxyType
from typing import Final

from analysis.report import wording
from analysis.report.content import Section
from analysis.report.sections.flow import is_half_finished, looks_sentence, places_words
from analysis.report.sections.verdicts import SIGNIFICANCE, verdicts
from analysis.report.subject import Subject
from analysis.results.pairwise import PairwiseResults
from analysis.results.preference import FEWEST
from analysis.results.report import TableReport
from analysis.stats.clustered_mean import LEVEL
from motion.errors import listed

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
        emotions = {one.emotion for one in subject.excerpts.values() if one.emotion}
        seconds = [one.seconds for one in subject.excerpts.values() if one.seconds is not None]
        parts = [
            *([wording.count(len(subject.speakers), "speaker")] if subject.speakers else []),
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
    conditions = listed([wording.condition(name) for name in subject.conditions])
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


FEW_SEGMENTS: Final = 6
"""Segments below which the text says what few of them mean."""


def limits_section(report: TableReport, subject: Subject) -> Section:
    """Return what a reader may not take from the report."""
    return Section(
        anchor="limits",
        heading="What may not be concluded",
        bullets=(
            *_sampled_people(report, subject),
            *_segments(subject),
            *_undecided(report),
            "Conditions: the motions shown, with one avatar, one camera and the questions as "
            "worded; not a system's other outputs, other questions or other speech.",
            *_metrics(subject),
        ),
    )


def _sampled_people(report: TableReport, subject: Subject) -> tuple[str, ...]:
    match subject.origin:
        case "rehearsal":
            return (
                "People: none. Simulated raters follow the rules they were given; nothing here "
                "tells what a person prefers.",
            )
        case "none":
            return ("Preference: nobody has answered.",)
        case _:
            unfinished = (
                (
                    f"The study is not finished ({places_words(report)}): numbers seen on the way "
                    "are no results, and to stop because of them makes false findings likelier.",
                )
                if is_half_finished(report, subject)
                else ()
            )
            return (
                f"People: {wording.count(report.participants.attentive, 'participant')}; the "
                "intervals speak about further participants found in the same way, not about "
                "everybody.",
                *unfinished,
            )


def _segments(subject: Subject) -> tuple[str, ...]:
    if not subject.excerpts:
        return (
            "Speech: segments are treated as a sample; the intervals speak about further segments "
            "such as these, not about other speakers or languages.",
        )
    speakers = subject.speakers
    emotions = [one.emotion for one in subject.excerpts.values() if one.emotion]
    count = len(subject.excerpts)
    bullets = [
        f"Speech: {wording.count(count, 'segment')}"
        + (f" of {listed(speakers)}" if len(speakers) in (1, 2, 3) else "")
        + "; the intervals speak about further segments such as these, not about other speakers, "
        "languages or situations."
        + (" One speaker tells nothing about other speakers." if len(speakers) == 1 else "")
        + (
            " With so few segments the intervals are wide, and more participants do not narrow "
            "them."
            if count < FEW_SEGMENTS
            else ""
        )
    ]
    fewest = min((emotions.count(emotion) for emotion in emotions), default=0)
    if len(set(emotions)) > 1 and fewest < FEW_SEGMENTS:
        bullets.append(
            f"Single emotions: some have {wording.count(fewest, 'segment')}, so that numbers by "
            "emotion describe these segments and test nothing."
        )
    return tuple(bullets)


def _undecided(report: TableReport) -> tuple[str, ...]:
    if not any(one.outcome == "undecided" for one in verdicts(report)):
        return ()
    if report.settings.margin is not None:
        return (
            "Equality: two conditions are as good as each other, within the margin, only where "
            "the test of equivalence says so.",
        )
    return (
        "Equality: that a test does not decide is no evidence that two conditions are equally "
        "good; no margin of equivalence was stated beforehand.",
    )


def _metrics(subject: Subject) -> tuple[str, ...]:
    if subject.metrics is None or not subject.metrics.conditions:
        return ()
    return (
        "Metrics: a better score is no better motion; deviation and diversity reward noise as much "
        "as variety.",
    )
