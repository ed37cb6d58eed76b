"""The database tables."""

from studyapp.database.tables.base import Base
from studyapp.database.tables.researchers import (
    Alarm,
    AuditLine,
    Event,
    ExclusionDecision,
    InterimFigures,
    LoginAttempt,
    Look,
    Researcher,
    ResearcherLink,
    ResearcherLogin,
)
from studyapp.database.tables.study_session import (
    FormAnswer,
    IntakeChange,
    Invitation,
    Newcomer,
    Place,
    RefusalLine,
    ScreenOut,
    StudySession,
    StudyVersion,
)
from studyapp.database.tables.trial import Response, Trial, TrialStimulus, Video, WatchRecord

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
