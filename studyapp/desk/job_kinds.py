"""The kinds of jobs that the desk runs: the command of each, and the files it makes."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

from motion.errors import InputError
from studyapp.desk.lab import OpenedStudy, current_lab, study_token
from studyapp.monitoring.overview import over_because, places_so_far
from studyapp.researchers.account import Right
from studyapp.researchers.audit import count_answers
from studyapp.researchers.logins import unblinding_reason
from studyapp.study.interview import MAX_PARTICIPANTS, read_count
from studyapp.web.research.page import visitor_cookie

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
    title, purpose : str
        Its title, and what it does.
    command : callable
        Returns the command with its arguments, given the study and the submitted form.
    needs : Right
        Opens it and its files; running it needs the right to steer the study too.
    shows_answers : bool
        Whether its files tell what participants answered.
    asks : str
        What its form asks for; empty for nothing.
    folder : str
        The folder in the study's whose files can be opened; empty for none.
    files : tuple of (str, str)
        Files in there, and what each is called; all of them where none is named.
    packed : str
        The folder that is offered as an archive; empty for none.
    """

    name: str
    title: str
    purpose: str
    command: Callable[[OpenedStudy, Form], tuple[str, ...]]
    needs: Right = Right.WATCH
    shows_answers: bool = False
    asks: str = ""
    folder: str = ""
    files: tuple[tuple[str, str], ...] = ()
    packed: str = ""

    def is_open(self, study: OpenedStudy) -> bool:
        """Return whether the researcher may see its files now."""
        has_right = study.account.may(self.needs)
        return has_right and not (self.shows_answers and reason_to_look(study) is None)


def reason_to_look(study: OpenedStudy) -> str | None:
    """Return why the researcher may see answers; None if a reason is still to be given.

    Empty where there are no answers yet, so that only a rehearsal can be seen.
    """
    with study.database.reading() as session:
        if not count_answers(session):
            return ""
    now, served, token = current_lab().clock.now(), study.study.served(), visitor_cookie()
    over = ""
    if served is not None:
        places = places_so_far(study.database, served, now)
        over = over_because(study.database, served.study, places)
    study_login = "" if token is None else study_token(token, study.name)
    return over or unblinding_reason(study.database, study_login, now) or None


def _fixed(*command: str) -> Callable[[OpenedStudy, Form], tuple[str, ...]]:
    return lambda study, form: command


RECORD: Final = "jobs/check/findings.json"
"""The findings of the last check, in the study's folder."""


def _check(study: OpenedStudy, form: Form) -> tuple[str, ...]:
    has_address = current_lab().origin and study.study.served() is not None
    return (
        "check",
        "--verbose",
        "--record",
        RECORD,
        *(["--address", f"{current_lab().origin}/{study.name}/"] if has_address else []),
    )


def _import(study: OpenedStudy, form: Form) -> tuple[str, ...]:
    fields = {key: form.get(key, "").strip() for key in ("speaker", "emotion", "segment", "fps")}
    options = [f"--{key}={value}" for key, value in fields.items() if value]
    return ("import", study.folder.inbox.name, ".", "--move", *options)


def _rehearse(study: OpenedStudy, form: Form) -> tuple[str, ...]:
    participants = form.get("participants", "").strip()
    if not participants:
        return ("rehearse",)
    count = read_count(participants, MAX_PARTICIPANTS, unit="participants")
    return ("rehearse", "--participants", str(count))


def _report(study: OpenedStudy, form: Form) -> tuple[str, ...]:
    reason = reason_to_look(study)
    motion = ["--with-motion"] if "motion" in form else []
    return ("report", ".", *motion, *(["--reason", reason] if reason else []))


def _export(study: OpenedStudy, *out: str) -> tuple[str, ...]:
    reason = reason_to_look(study)
    source = ["--reason", reason] if reason else []
    if reason == "" and study.folder.rehearsal.exists():
        source = ["--rehearsal"]
    return ("export", *out, *source)


TABLES: Final = "jobs/tables/answers"
SHARED: Final = "jobs/share/study"


def _figure(study: OpenedStudy, form: Form) -> tuple[str, ...]:
    kind, segment = form.get("figure", ""), form.get("segment", "")
    if kind not in FIGURES or segment not in segment_names(study):
        raise InputError("there is no such figure", remedy="Choose one of those in the form")
    return ("figure", kind, "--segment", segment)


def segment_names(study: OpenedStudy) -> list[str]:
    """Return the segments whose motion can be drawn; none where they cannot be read."""
    try:
        definition = study.folder.study()
        segments = () if definition.only_finished else study.folder.segments_of(definition)
    except InputError:
        return []
    return [segment.name for segment in segments]


BRING_IN: Final = JobKind(
    name="import",
    title="Bring in",
    purpose="Bring what was uploaded into the study",
    command=_import,
    needs=Right.STEER,
    asks="files",
)
"""It is run from the page of uploads."""

RUN: Final = (
    JobKind(
        name="generate",
        title="Generate",
        purpose="Make the motion of the conditions that name a generator",
        command=_fixed("generate", "."),
    ),
    JobKind(
        name="render",
        title="Render",
        purpose="Draw the videos that participants see",
        command=_fixed("render"),
    ),
    JobKind(
        name="check",
        title="Check",
        purpose="Find what can go wrong before launch",
        command=_check,
    ),
    JobKind(
        name="plan",
        title="Plan",
        purpose="Simulate how many participants and segments are needed",
        command=_fixed("plan", "."),
        folder="plan",
        files=(("power.png", "Figure"), ("power.csv", "Numbers")),
    ),
    JobKind(
        name="rehearse",
        title="Rehearse",
        purpose="Let simulated participants take part, and analyse what they answer",
        command=_rehearse,
        asks="participants",
        folder="rehearsal",
        files=(("recovery.html", "What it found"),),
    ),
    JobKind(
        name="metrics",
        title="Measure",
        purpose="Compute the automatic metrics, for the report",
        command=_fixed("metrics", "."),
    ),
)
"""Jobs that make a study ready, in their order."""

TAKE_HOME: Final = (
    JobKind(
        name="report",
        title="Report",
        purpose="Preferences and metrics side by side, with figures and tables",
        command=_report,
        needs=Right.UNBLIND,
        shows_answers=True,
        asks="motion",
        folder="report",
        files=(("report.html", "Open the report"),),
        packed="report",
    ),
    JobKind(
        name="tables",
        title="Tables of answers",
        purpose="One row for each answer, with a codebook",
        command=lambda study, form: _export(study, "--out", f"{TABLES}/responses.csv"),
        needs=Right.UNBLIND,
        shows_answers=True,
        packed=TABLES,
    ),
    JobKind(
        name="share",
        title="Folder for another lab",
        purpose="All that it takes to reproduce the report, without free text and names",
        command=lambda study, form: _export(study, "--folder", SHARED),
        needs=Right.UNBLIND,
        shows_answers=True,
        packed=SHARED,
    ),
    JobKind(
        name="figure",
        title="Figure for a paper",
        purpose="Conditions side by side, with their names",
        command=_figure,
        needs=Right.STEER,
        asks="figure",
        folder="figures",
    ),
)
"""Jobs whose files are downloaded."""

KINDS: Final = {kind.name: kind for kind in (BRING_IN, *RUN, *TAKE_HOME)}
