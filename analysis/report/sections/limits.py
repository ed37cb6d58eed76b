"""The section on what may not be concluded."""

from __future__ import annotations

from typing import Final

from analysis.report import wording
from analysis.report.content import Section
from analysis.report.sections.flow import is_half_finished, places_words
from analysis.report.sections.verdicts import verdicts
from analysis.report.subject import Subject
from analysis.results.report import TableReport
from motion.listing import listed

FEW: Final = 6
"""Segments below which the text says what few of them mean."""


def limits_section(report: TableReport, subject: Subject) -> Section:
    """Return what a reader may not take from the report."""
    return Section(
        anchor="limits",
        heading="What may not be concluded",
        bullets=(
            *_people(report, subject),
            *_segments(subject),
            *_undecided(report),
            "Conditions: the motions shown, with one avatar, one camera and the questions as "
            "worded; not a system's other outputs, other questions or other speech.",
            *_metrics(subject),
        ),
    )


def _people(report: TableReport, subject: Subject) -> tuple[str, ...]:
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
    speakers = sorted({one.speaker for one in subject.excerpts.values() if one.speaker})
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
            if count < FEW
            else ""
        )
    ]
    fewest = min((emotions.count(emotion) for emotion in emotions), default=0)
    if len(set(emotions)) > 1 and fewest < FEW:
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
