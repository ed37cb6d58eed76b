"""The database tables."""

from studyapp.database.tables.audit import (
    Alarm,
    AuditLine,
    Event,
    ExclusionDecision,
    InterimFigures,
    Look,
)
from studyapp.database.tables.base import Base
from studyapp.database.tables.researchers import (
    LoginAttempt,
    Researcher,
    ResearcherLink,
    ResearcherLogin,
)
from studyapp.database.tables.study_session import (
    FormAnswer,
    Invitation,
    Newcomer,
    Place,
    RefusalLine,
    ScreenOut,
    StudySession,
)
from studyapp.database.tables.study_version import IntakeChange, StudyVersion
from studyapp.database.tables.trial import Response, Trial, TrialStimulus
from studyapp.database.tables.video import Video, WatchRecord

__all__ = [
    "Alarm",
    "AuditLine",
    "Base",
    "Event",
    "ExclusionDecision",
    "FormAnswer",
    "IntakeChange",
    "InterimFigures",
    "Invitation",
    "LoginAttempt",
    "Look",
    "Newcomer",
    "Place",
    "RefusalLine",
    "Researcher",
    "ResearcherLink",
    "ResearcherLogin",
    "Response",
    "ScreenOut",
    "StudySession",
    "StudyVersion",
    "Trial",
    "TrialStimulus",
    "Video",
    "WatchRecord",
]
