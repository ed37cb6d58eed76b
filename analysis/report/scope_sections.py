"""The sections on what a result means: what it generalises to, settings and limits."""

from __future__ import annotations

from importlib.metadata import version

from analysis.report import wording
from analysis.report.answer import figure_order, people
from analysis.report.content import Section
from analysis.report.findings import SIGNIFICANCE, Findings
from analysis.report.inputs import ReportInputs
from motion.listing import listed


def generality_section(inputs: ReportInputs, findings: Findings) -> Section:
    """Return what the result may be generalised to, and what not."""
    analysed = findings.exclusion.analysed
    speakers = sorted({segment.speaker for segment in inputs.segments})
    emotions = list(dict.fromkeys(segment.emotion for segment in inputs.segments))
    seconds = sum(segment.duration for segment in inputs.segments)
    answered = inputs.origin != "none"
    bullets = [
        f"Speech: {wording.count(len(inputs.segments), 'segment')}, "
        f"{wording.quantity(seconds)} s in all, by "
        f"{wording.count(len(speakers), 'speaker')} ({listed(speakers)}), "
        f"{wording.count(len(emotions), 'emotion')} ({listed(emotions)})."
        + (
            " Segments are treated as a sample, so the intervals speak about further segments "
            "like these."
            if answered
            else ""
        )
        + (" One speaker tells nothing about other speakers." if len(speakers) == 1 else "")
    ]
    if inputs.origin == "rehearsal":
        bullets.append(
            "People: none. Simulated raters follow the rules they were given; nothing here tells "
            "what a person prefers."
        )
    elif inputs.origin == "participants":
        bullets.append(
            f"People: {findings.exclusion.sessions_analysed} participants recruited for this "
            "study; the intervals speak about further participants recruited in the same way."
        )
    if not analysed.empty:
        bullets.append(
            "Conditions: the motions shown, with one avatar, one camera and the questions as "
            "worded; not a method's other outputs, other questions or other speech."
        )
    return Section(anchor="generality", heading="What this generalises to", bullets=tuple(bullets))


def methods_section(inputs: ReportInputs, findings: Findings) -> Section:
    """Return settings and limits."""
    answered = inputs.origin != "none"
    asked = f"{people(inputs)} {'were' if answered else 'will be'} asked"
    bullets = [
        f"{wording.heading(name)}: {asked} “"
        f"{inputs.questions[name].replace('{emotion}', '[emotion]')}”"
        for name in figure_order(inputs)
    ]
    if answered:
        bullets += _statistics(inputs, findings)
    if inputs.frozen:
        held = listed([wording.name(channel) for channel in inputs.frozen])
        bullets.append(f"The videos hold {held} still; metrics look at the motion as shown.")
    bullets += inputs.notes
    bullets.append(f"Made with Motion Jury {version('motionjury')}.")
    return Section(anchor="methods", heading="Methods, settings and limits", bullets=tuple(bullets))


def _statistics(inputs: ReportInputs, findings: Findings) -> list[str]:
    """Return how answers become conclusions, and what these do not say."""
    return [
        "A study session is complete with "
        f"{findings.presentations * len(inputs.questions)} answers "
        f"({wording.count(findings.presentations, 'trial')} of "
        f"{wording.count(len(inputs.questions), 'question')})."
        + ("" if inputs.presentations else " This is the longest study session there is.")
        + (
            " One that reached its end although a video would not play counts as complete."
            if inputs.completed
            else ""
        ),
        f"A conclusion in the first sentences needs a Holm-corrected p below {SIGNIFICANCE:g}. "
        "“The answers do not decide” is not evidence that two conditions are equally good: no "
        "equivalence margin was declared.",
        "Tests are two-sided. With few segments the intervals are wide, because two or three "
        "segments say little about all others; more participants cannot make up for that.",
        "Where a one-way variance is larger than the two-way one, it takes its place, and a "
        "footnote says where. Where all answers are alike, or only one participant or segment "
        "answers, there is neither interval nor test.",
        "Intervals treat the five levels as win, tie and loss; how strong a preference is shows "
        "only in the counts.",
    ]
