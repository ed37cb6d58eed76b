"""Everything that can go wrong before a study is launched."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Final

from motion.errors import InputError
from studyapp.preflight.catch_checks import catch_picture_findings
from studyapp.preflight.design_checks import balance_findings, design_findings
from studyapp.preflight.finding import SEVERITIES, Finding, finding
from studyapp.preflight.finished_video_checks import finished_video_findings
from studyapp.preflight.material import Material
from studyapp.preflight.motion_checks import motion_findings
from studyapp.preflight.recruiting_checks import (
    made_findings,
    page_findings,
    pay_findings,
    recruiting_findings,
)
from studyapp.preflight.serving_checks import address_findings, read_findings, serving_findings
from studyapp.preflight.shown_video_checks import shown_video_findings, weight_findings
from studyapp.preflight.sound_checks import sound_findings
from studyapp.preflight.time_checks import (
    Pace,
    expected_time,
    minutes_needed,
    pace_of_pilot,
    pace_of_study,
    time_findings,
)
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.reading import parse_text, read_text
from studyapp.study.settings.study import Study

OnStep = Callable[[str], None]


def check(
    folder: StudyFolder,
    *,
    address: str | None = None,
    pilot: StudyFolder | None = None,
    on_step: OnStep = lambda _what: None,
) -> list[Finding]:
    """Return everything worth knowing before launch, errors first.

    Parameters
    ----------
    address : str, optional
        Where participants will come to; the study is asked for there.
    pilot : StudyFolder, optional
        A study that people have taken, whose pace tells how long this one takes.
    on_step : callable
        Called with what is looked at next.

    Raises
    ------
    InputError
        If the pilot tells nothing.
    """
    pace = None if pilot is None else pace_of_pilot(pilot)
    findings = list(_findings(folder, pace, on_step))
    if address is not None:
        findings += address_findings(address)
    return sorted(findings, key=lambda found: SEVERITIES.index(found.severity))


def _findings(folder: StudyFolder, pace: Pace | None, on_step: OnStep) -> Iterator[Finding]:
    try:
        study = parse_text(read_text(folder.definition), where=folder.definition)
    except InputError as wrong:
        for problem in wrong.what.split("; "):
            yield finding("study-file", problem, where="study.toml", remedy=wrong.remedy)
        return
    yield from page_findings(study)
    yield from recruiting_findings(study)
    yield from made_findings(study, folder.root)
    try:
        material = Material.of(folder, study)
    except InputError as missing:
        of_videos = folder.stimuli.name in missing.where
        yield finding(
            "video-list-unreadable" if of_videos else "speech-unreadable",
            missing.what,
            where=missing.where.removeprefix(f"{folder.root}/"),
            remedy=missing.remedy or None,
        )
        yield from pay_findings(study, None)
        return
    yield from _material_findings(material, study, pace, on_step)


_LOOKS: Final[tuple[tuple[str, Callable[[Material], Iterable[Finding]]], ...]] = (
    ("finished videos", finished_video_findings),
    ("what videos show", shown_video_findings),
    ("sound", sound_findings),
    ("weight of pages", weight_findings),
    ("motion", motion_findings),
    ("catch trials", catch_picture_findings),
    ("design", design_findings),
    ("balance", balance_findings),
    ("serving", serving_findings),
)


def _material_findings(
    material: Material, study: Study, pace: Pace | None, on_step: OnStep
) -> Iterator[Finding]:
    """Look at everything; only a study without errors is read as its server does."""
    expected = expected_time(material)
    findings: list[Finding] = []
    for what, look in _LOOKS:
        on_step(what)
        findings += look(material)
    if expected is None:
        findings += pay_findings(study, None)
    else:
        seen = pace or _own_pace(material)
        findings += time_findings(study, expected, seen)
        findings += pay_findings(study, minutes_needed(expected, seen))
    yield from findings
    if not any(found.severity == "error" for found in findings):
        on_step("the study as it is served")
        yield from read_findings(material)


def _own_pace(material: Material) -> Pace | None:
    """Return the pace of who has finished the study; None also where its database is unusable."""
    try:
        return pace_of_study(material)
    except InputError:
        return None
