"""The database tables."""

from studyapp.models.arrivals import Invitation, Newcomer, RefusalLine, ScreenOut
from studyapp.models.audit import AuditLine, Event, ExclusionDecision, Look
from studyapp.models.base import Base
from studyapp.models.monitoring import Alarm, InterimFigures
from studyapp.models.researchers import LoginAttempt, Researcher, ResearcherLink, ResearcherLogin
from studyapp.models.study_session import FormAnswer, Place, StudySession
from studyapp.models.study_version import IntakeChange, StudyVersion
from studyapp.models.trial import Response, Trial, TrialStimulus
from studyapp.models.video import Video, WatchRecord

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
