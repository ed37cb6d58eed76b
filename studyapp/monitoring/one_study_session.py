"""One study session, with its events in order."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Final, NamedTuple

from sqlalchemy import select
from sqlalchemy.orm import selectinload

from studyapp.database.engine import Database
from studyapp.database.tables.researchers import ExclusionDecision
from studyapp.database.tables.study_session import RefusalLine, StudySession
from studyapp.database.tables.trial import Trial, TrialStimulus, Video, WatchRecord
from studyapp.monitoring.study_sessions import SessionProgress, progress_of_sessions
from studyapp.researchers.exclusion_decisions import exclusion_decisions
from studyapp.session.ending import JUDGED, has_failed
from studyapp.session.served_study import ServedStudy
from studyapp.session.watch_evidence import MAX_RATE, watched_seconds, watched_share
from studyapp.study.design.trial import Content, Stimulus
from studyapp.study.settings.study import Study


@dataclass(frozen=True, kw_only=True)
class Event:
    """An event of a study session.

    Attributes
    ----------
    at : datetime
    what : str
        A sentence without a full stop; never an answer.
    trial : int or None
        Position of its trial.
    video : int or None
        Number of its video in that trial.
    trouble : bool
        Whether something went wrong.
    """

    at: datetime
    what: str
    trial: int | None = None
    video: int | None = None
    trouble: bool = False


class ShownTrial(NamedTuple):
    """One trial, without its conditions and answers.

    `watched` is the share of its videos that counts as watched; `outcome` is empty for a trial that
    is still to come.
    """

    position: int
    kind: str
    segment: str
    emotion: str
    seconds: float | None
    watched: float
    outcome: str


@dataclass(frozen=True, kw_only=True)
class OneStudySession:
    """What researchers see of one study session while data are collected.

    Attributes
    ----------
    row : StudySession
        What is stored of it, with its version and its answers to the form.
    decisions : sequence of ExclusionDecision
        Researchers' decisions about the participant, newest first.
    """

    progress: SessionProgress
    row: StudySession
    trials: tuple[ShownTrial, ...]
    events: tuple[Event, ...]
    decisions: Sequence[ExclusionDecision]


def one_study_session(
    database: Database, served: ServedStudy, number: int, now: datetime
) -> OneStudySession | None:
    """Return the study session `number`, None if there is none."""
    query = (
        select(StudySession)
        .where(StudySession.id == number)
        .options(
            selectinload(StudySession.version),
            selectinload(StudySession.form_answers),
            selectinload(StudySession.trials).options(
                selectinload(Trial.responses),
                selectinload(Trial.stimuli),
                selectinload(Trial.videos).options(
                    selectinload(Video.watch_record), selectinload(Video.stimuli)
                ),
            ),
        )
    )
    refused = select(RefusalLine).where(RefusalLine.study_session_id == number)
    with database.reading() as session:
        study_session = session.scalars(query).first()
        if study_session is None:
            return None
        (progress,) = progress_of_sessions(session, served, now, only=number)
        events = [*_own_events(study_session), *map(_refused, session.scalars(refused))]
        return OneStudySession(
            progress=progress,
            row=study_session,
            trials=tuple(_shown_trial(served.study, trial) for trial in study_session.trials),
            events=tuple(sorted(events, key=lambda event: event.at)),
            decisions=exclusion_decisions(session, number),
        )


def contents_shown(database: Database, number: int, position: int) -> dict[int, Content]:
    """Return the content of each video of a trial of the study session `number`, by its number."""
    query = (
        select(Video.number, TrialStimulus.condition, TrialStimulus.segment, TrialStimulus.speech)
        .join(TrialStimulus.video)
        .join(Video.trial)
        .where(Trial.study_session_id == number, Trial.position == position)
        .order_by(Video.number, TrialStimulus.number)
    )
    contents: dict[int, Content] = {}
    with database.reading() as session:
        for video, condition, segment, speech in session.execute(query):
            stimulus = Stimulus(condition=condition, segment=segment, speech=speech)
            contents[video] = (*contents.get(video, ()), stimulus)
    return contents


def _shown_trial(study: Study, trial: Trial) -> ShownTrial:
    records = [(video, video.watch_record) for video in trial.videos]
    return ShownTrial(
        position=trial.position,
        kind=trial.kind,
        segment=trial.segment,
        emotion=trial.emotion,
        seconds=trial.seconds,
        watched=watched_share(
            (video.duration, video.sent_at, None if record is None else record.intervals)
            for video, record in records
        ),
        outcome=_outcome(study, trial),
    )


def _outcome(study: Study, trial: Trial) -> str:
    if trial.unplayable_at is not None:
        return "does not play"
    if trial.answered_at is None:
        return ""
    if trial.kind not in JUDGED:
        return "answered"
    return "failed" if has_failed(study, trial) else "passed"


def _own_events(study_session: StudySession) -> Iterator[Event]:
    """Yield what happened, trial after trial."""
    yield Event(at=study_session.consented_at, what="Agreed to take part")
    forms = dict.fromkeys((each.answered_at, each.stage) for each in study_session.form_answers)
    for moment, stage in forms:
        yield Event(at=moment, what=f"Answered {_ASKED[stage]}")
    if study_session.sound_checked_at is not None:
        tries = (
            f" after {study_session.sound_tries} wrong tries" if study_session.sound_tries else ""
        )
        yield Event(at=study_session.sound_checked_at, what=f"Heard the sound check{tries}")
    if study_session.started_at is not None:
        yield Event(at=study_session.started_at, what="Began the trials")
    for trial in study_session.trials:
        yield from _trial_events(trial)
    if study_session.completed_at is not None:
        yield Event(at=study_session.completed_at, what="Finished, and got a completion code")
    if study_session.withdrawn_at is not None:
        yield Event(at=study_session.withdrawn_at, what="Withdrew", trouble=True)


_ASKED: Final = {
    "eligibility": "the questions about eligibility",
    "consent": "the questions about consent",
    "demographics": "the questions about themselves",
    "comprehension": "the questions about the instructions",
    "closing": "the last questions",
}


def _trial_events(trial: Trial) -> Iterator[Event]:
    place = trial.position
    if trial.shown_at is not None:
        yield Event(at=trial.shown_at, what=f"Trial {place} was shown", trial=place)
    for video in trial.videos:
        if video.watch_record is not None:
            yield _played(trial, video, video.watch_record)
        if video.unplayable_at is not None:
            what = f"Said that {_video(trial, video)} does not play"
            yield Event(
                at=video.unplayable_at, what=what, trial=place, video=video.number, trouble=True
            )
    if trial.answered_at is not None:
        yield Event(at=trial.answered_at, what=f"Answered trial {place}", trial=place)
    if trial.unplayable_at is not None:
        what = f"Went on without trial {place}"
        yield Event(at=trial.unplayable_at, what=what, trial=place, trouble=True)


def _played(trial: Trial, video: Video, record: WatchRecord) -> Event:
    watched = watched_seconds(video.sent_at, record.intervals)
    notes = [
        f"Had played {record.played_seconds:.1f} s of {_video(trial, video)}",
        f"{watched:.1f} s of its {video.duration:.1f} s count as watched",
    ]
    if video.sent_at is None:
        notes.append("though it was never sent")
    if record.rate > MAX_RATE:
        notes.append(f"at up to {record.rate:.2g} times the speed")
    if record.hidden_seconds:
        notes.append(f"{record.hidden_seconds:.1f} s out of sight")
    if record.silent_seconds and not video.soundless:
        notes.append(f"{record.silent_seconds:.1f} s unheard")
    if record.stalls:
        notes.append(f"{record.stalls} stalls of {record.stalled_seconds:.1f} s")
    return Event(
        at=record.reported_at,
        what=", ".join(notes),
        trial=trial.position,
        video=video.number,
        trouble=len(notes) > 2,
    )


def _video(trial: Trial, video: Video) -> str:
    if len(trial.videos) == 1:
        return "the video"
    return f"video {video.number}" if video.number else "the reference"


def _refused(line: RefusalLine) -> Event:
    return Event(at=line.at, what=f"Was refused: {line.detail}", trouble=True)
