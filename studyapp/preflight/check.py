"""All checks of a study before its launch."""

from collections.abc import Callable, Iterable, Iterator
from typing import Final

from motion.errors import InputError
from studyapp.preflight import (
    design_checks,
    motion_checks,
    recruiting_checks,
    serving_checks,
    sound_checks,
    time_checks,
    video_checks,
)
from studyapp.preflight.finding import SEVERITIES, Finding, finding_of_error, make_finding
from studyapp.preflight.material import Material
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.reading import parse_text, read_text

OnStep = Callable[[str], None]


def check(
    folder: StudyFolder,
    *,
    address: str | None = None,
    on_step: OnStep = lambda _step: None,
) -> list[Finding]:
    """Return all findings of a study, errors first.

    Parameters
    ----------
    address : str, optional
        The address that participants will use; requests are sent there.
    on_step : callable
        Called with the name of the next check.
    """
    findings = list(_findings(folder, on_step))
    if address is not None:
        findings += serving_checks.address_findings(address)
    return sorted(findings, key=lambda finding: SEVERITIES.index(finding.severity))


def _findings(folder: StudyFolder, on_step: OnStep) -> Iterator[Finding]:
    try:
        study = parse_text(read_text(folder.definition), where=folder.definition)
    except InputError as error:
        for problem in error.what.split("; "):
            yield make_finding("study-file", problem, where="study.toml", remedy=error.remedy)
        return
    yield from recruiting_checks.page_findings(study)
    yield from recruiting_checks.recruiting_findings(study)
    yield from recruiting_checks.prolific_code_findings(study, folder.root)
    try:
        material = Material.read(folder, study)
    except InputError as error:
        yield finding_of_error(
            "video-list-unreadable" if folder.stimuli.name in error.where else "speech-unreadable",
            error,
            where=error.where.removeprefix(f"{folder.root}/"),
        )
        yield from recruiting_checks.pay_findings(study, None)
        return
    yield from _material_findings(material, on_step)


_CHECKS: Final[tuple[tuple[str, Callable[[Material], Iterable[Finding]]], ...]] = (
    ("finished videos", video_checks.finished_video_findings),
    ("what videos show", video_checks.shown_video_findings),
    ("sound", sound_checks.sound_findings),
    ("weight of pages", video_checks.weight_findings),
    ("motion", motion_checks.motion_findings),
    ("design", design_checks.design_findings),
    ("balance", design_checks.balance_findings),
    ("serving", serving_checks.serving_findings),
)


def _material_findings(material: Material, on_step: OnStep) -> Iterator[Finding]:
    """Run all checks, and read a study without errors as its server will."""
    expected, needed = time_checks.expected_time(material), None
    findings: list[Finding] = []
    for name, check_material in _CHECKS:
        on_step(name)
        findings += check_material(material)
    if expected is not None:
        findings += time_checks.time_findings(material.study, expected)
        needed = time_checks.minutes_needed(expected)
    findings += recruiting_checks.pay_findings(material.study, needed)
    yield from findings
    if not any(finding.severity == "error" for finding in findings):
        on_step("the study as it is served")
        yield from serving_checks.server_findings(material)
