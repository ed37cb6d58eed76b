"""What may spoil the data: failed checks, and videos that did not play well.

Catch trials and attention checks tell who failed them, and which of them careful raters fail.
"""

from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

from sqlalchemy import ColumnElement, and_, case, exists, func, or_, select
from sqlalchemy.orm import Session, aliased

from studyapp.database.tables.trial import Response, Trial, TrialStimulus, Video, WatchRecord
from studyapp.session.ending import JUDGED, JudgedTrial
from studyapp.study.settings.study import Study


class Check(NamedTuple):
    """One catch trial or attention check that a participant has answered or skipped.

    Attributes
    ----------
    item : str
        Its segment and, of a catch trial, the conditions shown.
    failed : bool
        A skipped one counts as failed.
    answered : bool
        Whether it was answered, not skipped.
    """

    study_session: int
    kind: str
    item: str
    failed: bool
    answered: bool = True


@dataclass(frozen=True, kw_only=True)
class CheckedItem:
    """One catch trial or attention check that several participants were given.

    Attributes
    ----------
    answered, failed : int
    careful, careful_failed : int
        The same for participants who failed none of their other checks.
    """

    kind: str
    item: str
    answered: int
    failed: int
    careful: int
    careful_failed: int


def checks(session: Session, study: Study, study_sessions: Collection[int]) -> list[Check]:
    """Judge every check that was answered or skipped in `study_sessions`."""
    settled = or_(Trial.answered_at.is_not(None), Trial.unplayable_at.is_not(None))
    query = select(
        Trial.id,
        Trial.study_session_id,
        Trial.kind,
        Trial.part,
        Trial.segment,
        Trial.expected,
        Trial.instructed,
        Trial.answered_at.is_not(None),
    )
    rows = session.connection().execute(
        query.where(Trial.kind.in_(JUDGED), settled).order_by(Trial.id)
    )
    shown, names = _conditions(session), study.display_names
    answers = _answers(session)
    judged_checks = []
    for trial_id, study_session, kind, part, segment, expected, instructed, answered in rows:
        if study_session not in study_sessions:
            continue
        conditions = shown.get(trial_id, ())
        judged = JudgedTrial(kind, part, conditions, expected, instructed)
        labels = sorted(names.get(condition, condition) for condition in conditions)
        pair = f": {' and '.join(labels)}" if kind == "catch" else ""
        failed = not answered or study.failed(judged, answers.get(trial_id, {}))
        judged_checks.append(Check(study_session, kind, f"{segment}{pair}", failed, answered))
    return judged_checks


def checked_items(judged_checks: Sequence[Check]) -> tuple[CheckedItem, ...]:
    """Return how each check was answered, those failed most often first.

    A skipped check tells something of the participant, but nothing of the check.
    """
    failures: dict[int, int] = defaultdict(int)
    for check in judged_checks:
        failures[check.study_session] += check.failed
    by_item: dict[tuple[str, str], list[Check]] = defaultdict(list)
    for check in judged_checks:
        if check.answered:
            by_item[check.kind, check.item].append(check)
    items = [
        _item(kind, item, item_checks, failures)
        for (kind, item), item_checks in sorted(by_item.items())
    ]
    return tuple(sorted(items, key=lambda item: -item.failed / item.answered))


def failed_by_session(judged_checks: Iterable[Check], kind: str) -> dict[int, int]:
    """Return how many checks of `kind` each study session failed, if it had any."""
    failures: dict[int, int] = {}
    for check in judged_checks:
        if check.kind == kind:
            failures[check.study_session] = failures.get(check.study_session, 0) + check.failed
    return failures


def _item(
    kind: str, item: str, item_checks: Sequence[Check], failures: dict[int, int]
) -> CheckedItem:
    careful = [check for check in item_checks if failures[check.study_session] == check.failed]
    return CheckedItem(
        kind=kind,
        item=item,
        answered=len(item_checks),
        failed=sum(check.failed for check in item_checks),
        careful=len(careful),
        careful_failed=sum(check.failed for check in careful),
    )


def _conditions(session: Session) -> dict[int, tuple[str, ...]]:
    """Return the conditions that each check shows, number 1 first."""
    query = select(TrialStimulus.trial_id, TrialStimulus.condition).join(TrialStimulus.trial)
    query = query.where(Trial.kind.in_(JUDGED), TrialStimulus.number > 0)
    conditions: dict[int, tuple[str, ...]] = defaultdict(tuple)
    for trial, condition in session.connection().execute(query.order_by(TrialStimulus.number)):
        conditions[trial] += (condition,)
    return conditions


def _answers(session: Session) -> dict[int, dict[tuple[str, int | None], int]]:
    query = select(Response.trial_id, Response.question, Response.stimulus, Response.value)
    query = query.join(Response.trial).where(Trial.kind.in_(JUDGED))
    answers: dict[int, dict[tuple[str, int | None], int]] = defaultdict(dict)
    for trial, question, stimulus, value in session.connection().execute(query):
        answers[trial][question, stimulus] = value
    return answers


NOTICEABLE: Final = 0.05
"""Share of dropped frames that an attentive eye may notice."""


@dataclass(frozen=True, kw_only=True)
class VideoShowings:
    """How one video played in all its showings.

    Attributes
    ----------
    what : str
        Its segment and conditions, from left to right.
    shown : int
        How often any of it was played, or was said not to play.
    stalled : int
        In how many showings it waited for data.
    stalled_seconds : float
        For how long in all.
    dropped_share : float or None
        Share of the frames that browsers dropped, in [0, 1]; None if no browser counts them.
    unplayable : int
        How often somebody said that it does not play.
    """

    what: str
    shown: int
    stalled: int
    stalled_seconds: float
    dropped_share: float | None
    unplayable: int

    @property
    def troubled(self) -> bool:
        """Whether anything went wrong."""
        is_jerky = self.dropped_share is not None and self.dropped_share >= NOTICEABLE
        return self.stalled > 0 or self.unplayable > 0 or is_jerky


def played_videos(session: Session, names: Mapping[str, str]) -> tuple[VideoShowings, ...]:
    """Return how each video played that anybody began to watch, the most trouble first.

    Parameters
    ----------
    names : mapping of str to str
        Display names of conditions.
    """
    videos = []
    for row in session.connection().execute(_PLAYED):
        segment, first, second, shown, stalled, seconds, frames, dropped, unplayable = row
        conditions = [names.get(name, name) for name in (first, second) if name]
        videos.append(
            VideoShowings(
                what=f"{segment}: {' | '.join(conditions)}",
                shown=shown,
                stalled=stalled,
                stalled_seconds=float(seconds),
                dropped_share=int(dropped or 0) / int(frames) if frames else None,
                unplayable=unplayable,
            )
        )
    return tuple(
        sorted(videos, key=lambda each: (-each.unplayable, -each.stalled / each.shown, each.what))
    )


# A video shows one stimulus, or two beside each other.
_FIRST, _SECOND, _EARLIER = (aliased(TrialStimulus) for _ in range(3))


def _same_video(one: type[TrialStimulus], other: type[TrialStimulus]) -> ColumnElement[bool]:
    return and_(one.trial_id == other.trial_id, one.video_id == other.video_id)


_PLAYED = (
    select(
        _FIRST.segment,
        _FIRST.condition,
        _SECOND.condition,
        func.count(),
        func.sum(case((WatchRecord.stalls > 0, 1), else_=0)),
        func.coalesce(func.sum(WatchRecord.stalled_seconds), 0.0),
        func.sum(case((WatchRecord.frames > 0, WatchRecord.frames))),
        func.sum(case((WatchRecord.frames > 0, WatchRecord.dropped_frames))),
        func.count(Video.unplayable_at),
    )
    .select_from(Video)
    .outerjoin(WatchRecord, WatchRecord.video_id == Video.id)
    .join(_FIRST, and_(_FIRST.trial_id == Video.trial_id, _FIRST.video_id == Video.id))
    .outerjoin(_SECOND, and_(_same_video(_SECOND, _FIRST), _SECOND.number > _FIRST.number))
    .where(
        WatchRecord.id.is_not(None) | Video.unplayable_at.is_not(None),
        ~exists().where(_same_video(_EARLIER, _FIRST), _EARLIER.number < _FIRST.number),
    )
    .group_by(_FIRST.segment, _FIRST.condition, _SECOND.condition)
)
