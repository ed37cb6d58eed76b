"""What can go wrong before a study is launched."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

from motion.segment import EMOTIONS
from studyapp.definition.folder import StudyFolder
from studyapp.definition.stimuli import read_stimuli
from studyapp.definition.study import Study
from studyapp.design.trial_count import planned_trials


class Severity(Enum):
    """How much a finding matters."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True)
class Finding:
    """One finding: what it is, how much it matters, and what to do."""

    severity: Severity
    what: str
    remedy: str = ""


def check(folder: StudyFolder) -> list[Finding]:
    """Return everything worth knowing before launch, errors first.

    Raises
    ------
    InputError
        If the study file or the segments cannot be read at all.
    """
    study = folder.study()
    findings = [
        *_media_findings(folder, study),
        *_page_findings(study),
        *_design_findings(folder, study),
    ]
    order = list(Severity)
    return sorted(findings, key=lambda finding: order.index(finding.severity))


def _media_findings(folder: StudyFolder, study: Study) -> Iterator[Finding]:
    segments = folder.segments()
    for segment in segments:
        if not (folder.speech / segment.wav).exists():
            yield Finding(
                Severity.ERROR,
                f"segment {segment.name}: speech/{segment.wav} is missing",
                "Put the file back, or import the take again",
            )
    stimuli = read_stimuli(folder.stimuli)
    pairs = {(pair.segment, pair.left, pair.right): pair for pair in stimuli.pairs}
    for segment in segments:
        for left, right in study.pairs:
            pair = pairs.get((segment.name, left, right))
            if pair is None or not (folder.root / pair.file).exists():
                yield Finding(
                    Severity.ERROR,
                    f"the video of {left!r} beside {right!r} for segment {segment.name} is missing",
                    "Run 'motionjury render'",
                )
            elif abs(pair.duration - segment.duration) > 1e-6:
                yield Finding(
                    Severity.ERROR,
                    f"{pair.file} lasts {pair.duration:g} s, its segment {segment.duration:g} s",
                    "The segments changed: run 'motionjury generate' and 'motionjury render'",
                )


def _page_findings(study: Study) -> Iterator[Finding]:
    for key, why in (
        ("organisation", "participants are not told who runs the study"),
        ("contact", "participants have nobody to ask"),
        ("payment", "participants are not told what they get"),
    ):
        if not getattr(study.page, key):
            yield Finding(Severity.WARNING, why, f"Fill in page.{key} in study.toml")


def _design_findings(folder: StudyFolder, study: Study) -> Iterator[Finding]:
    segments = folder.segments()
    for sentence in planned_trials(study, segments).sentences:
        yield Finding(Severity.NOTE, sentence.rstrip("."))
    missing = [e for e in EMOTIONS if e not in {segment.emotion for segment in segments}]
    if missing and any("{emotion}" in question.text for question in study.questions):
        yield Finding(
            Severity.NOTE,
            f"no segment has the emotion {', '.join(missing)}: the results say nothing about it",
        )
    for sentence in study_notes(study):
        yield Finding(Severity.NOTE, sentence.rstrip("."))
    if not study.catch.trials:
        yield Finding(
            Severity.WARNING,
            "there are no catch trials, so inattentive participants cannot be told apart",
            "Set catch.trials in study.toml",
        )


def study_notes(study: Study) -> tuple[str, ...]:
    """Return what a reader of the results must know of the study's conditions."""
    if study.has_recording or not study.catch.trials:
        return ()
    return (
        "No condition is a recording of a person, so there is no ground truth: "
        f"catch trials show {study.catch_against} against {study.catch.condition}.",
    )
