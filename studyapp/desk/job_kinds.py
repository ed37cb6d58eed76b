"""What the desk can run of a study: which command each kind of job is, and what comes of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

from motion.errors import InputError
from studyapp.desk.lab import OpenedStudy, current_lab, study_token
from studyapp.researchers.account import Right
from studyapp.researchers.audit import answers_so_far
from studyapp.researchers.logins import unblinded_because
from studyapp.study.interview import MAX_PARTICIPANTS, read_count
from studyapp.web.research.page import visitor_cookie
from studyapp.web.research.results import over_because

Form = Mapping[str, str]

FIGURES: Final = {
    "strip": "a strip of frames, one row for each condition",
    "grid": "a video of all conditions side by side",
}


@dataclass(frozen=True, kw_only=True)
class JobKind:
    """Something that the desk can run.

    Attributes
    ----------
    name : str
        In addresses, and of its folder.
    title, words : str
        What it is called, and what it does.
    command : callable
        Returns the command with its arguments, of the study and of what a form says.
    sees : Right
        Who sees it and what comes of it; running it needs the right to steer the study too.
    shows_answers : bool
        Whether what comes of it tells what participants answered.
    asks : str
        What its form asks for; empty for nothing.
    place : str
        The folder in the study's whose files can be opened; empty for none.
    opens : tuple of (str, str)
        Files in there, and what each is called.
    packed : str
        The folder that is offered as an archive; empty for none.
    """

    name: str
    title: str
    words: str
    command: Callable[[OpenedStudy, Form], tuple[str, ...]]
    sees: Right = Right.WATCH
    shows_answers: bool = False
    asks: str = ""
    place: str = ""
    opens: tuple[tuple[str, str], ...] = ()
    packed: str = ""

    def is_open(self, study: OpenedStudy) -> bool:
        """Tell whether the researcher may see what comes of it now."""
        has_right = study.account.may(self.sees)
        return has_right and not (self.shows_answers and reason_to_look(study) is None)


def reason_to_look(study: OpenedStudy) -> str | None:
    """Return why the researcher sees answers; None where that is still to be said.

    Empty where there are none yet, so that nothing can be seen but a rehearsal.
    """
    with study.database.reading() as session:
        if not answers_so_far(session):
            return ""
    now, served, token = current_lab().clock.now(), study.study.served(), visitor_cookie()
    over = "" if served is None else over_because(study.database, served, now)
    own = "" if token is None else study_token(token, study.name)
    return over or unblinded_because(study.database, own, now) or None


def _fixed(*command: str) -> Callable[[OpenedStudy, Form], tuple[str, ...]]:
    return lambda study, form: command


RECORD: Final = "jobs/check/findings.json"
"""What the last check found, in the study's folder."""


def _check(study: OpenedStudy, form: Form) -> tuple[str, ...]:
    has_address = current_lab().origin and study.study.served() is not None
    return (
        "check",
        "--record",
        RECORD,
        *(["--address", f"{current_lab().origin}/{study.name}/"] if has_address else []),
    )


def _import(study: OpenedStudy, form: Form) -> tuple[str, ...]:
    given = {key: form.get(key, "").strip() for key in ("speaker", "emotion", "segment", "fps")}
    stated = [f"--{key}={value}" for key, value in given.items() if value]
    return ("import", study.folder.inbox.name, ".", "--move", *stated)


def _rehearse(study: OpenedStudy, form: Form) -> tuple[str, ...]:
    given = form.get("participants", "").strip()
    if not given:
        return ("rehearse",)
    count = read_count(given, MAX_PARTICIPANTS, what="participants")
    return ("rehearse", "--participants", str(count))


def _report(study: OpenedStudy, form: Form) -> tuple[str, ...]:
    reason = reason_to_look(study)
    played = ["--with-motion"] if "motion" in form else []
    return ("report", ".", *played, *(["--reason", reason] if reason else []))


def _export(study: OpenedStudy, *out: str) -> tuple[str, ...]:
    reason = reason_to_look(study)
    whose = ["--reason", reason] if reason else []
    if reason == "" and study.folder.rehearsal.exists():
        whose = ["--rehearsal"]
    return ("export", *out, *whose)


TABLES: Final = "jobs/tables/answers"
SHARED: Final = "jobs/share/study"


def _figure(study: OpenedStudy, form: Form) -> tuple[str, ...]:
    kind, segment = form.get("figure", ""), form.get("segment", "")
    if kind not in FIGURES or segment not in segment_names(study):
        raise InputError("there is no such figure", remedy="Choose one of those in the form")
    return ("figure", kind, "--segment", segment)


def segment_names(study: OpenedStudy) -> list[str]:
    """Return the study's segments; none where they cannot be read."""
    try:
        return [each.name for each in study.folder.segments_of(study.folder.study())]
    except InputError:
        return []


BRING_IN: Final = (
    JobKind(
        name="import",
        title="Bring in",
        words="Bring what was uploaded into the study",
        command=_import,
        sees=Right.STEER,
        asks="files",
    ),
)
"""What is run from the page of uploads."""

RUN: Final = (
    JobKind(
        name="generate",
        title="Generate",
        words="Make the motion of the conditions that name a generator",
        command=_fixed("generate", "."),
    ),
    JobKind(
        name="render",
        title="Render",
        words="Draw the videos that participants see",
        command=_fixed("render"),
    ),
    JobKind(
        name="check",
        title="Check",
        words="Find what can go wrong before launch",
        command=_check,
    ),
    JobKind(
        name="plan",
        title="Plan",
        words="Simulate how many participants and segments are needed",
        command=_fixed("plan", "."),
        place="plan",
        opens=(("power.png", "Figure"), ("power.csv", "Numbers")),
    ),
    JobKind(
        name="rehearse",
        title="Rehearse",
        words="Let simulated participants take part, and analyse what they answer",
        command=_rehearse,
        asks="participants",
        place="rehearsal",
        opens=(("recovery.html", "What it found"),),
    ),
    JobKind(
        name="metrics",
        title="Measure",
        words="Compute the automatic metrics, for the report",
        command=_fixed("metrics", "."),
    ),
)
"""What makes a study ready, in its order."""

TAKE_HOME: Final = (
    JobKind(
        name="report",
        title="Report",
        words="Preferences and metrics side by side, with figures and tables",
        command=_report,
        sees=Right.UNBLIND,
        shows_answers=True,
        asks="motion",
        place="report",
        opens=(("report.html", "Open the report"),),
        packed="report",
    ),
    JobKind(
        name="tables",
        title="Tables of answers",
        words="One row for each answer, with a codebook",
        command=lambda study, form: _export(study, "--out", f"{TABLES}/responses.csv"),
        sees=Right.UNBLIND,
        shows_answers=True,
        packed=TABLES,
    ),
    JobKind(
        name="share",
        title="Folder for another lab",
        words="All that repeats the report, without free text and names",
        command=lambda study, form: _export(study, "--folder", SHARED),
        sees=Right.UNBLIND,
        shows_answers=True,
        packed=SHARED,
    ),
    JobKind(
        name="figure",
        title="Figure for a paper",
        words="Conditions beside each other, by name",
        command=_figure,
        sees=Right.STEER,
        asks="figure",
        place="figures",
    ),
)
"""What can be downloaded."""

KINDS: Final = {kind.name: kind for kind in (*BRING_IN, *RUN, *TAKE_HOME)}
