"""The database tables, one a file."""

from studyapp.models.alarm import Alarm
from studyapp.models.audit_line import AuditLine, Event
from studyapp.models.base import Base
from studyapp.models.exclusion_decision import ExclusionDecision
from studyapp.models.form_answer import FormAnswer
from studyapp.models.intake_change import IntakeChange
from studyapp.models.interim_figures import InterimFigures
from studyapp.models.invitation import Invitation
from studyapp.models.login_attempt import LoginAttempt
from studyapp.models.look import Look
from studyapp.models.newcomer import Newcomer
from studyapp.models.place import Place
from studyapp.models.refusal_line import RefusalLine
from studyapp.models.researcher import Researcher
from studyapp.models.researcher_link import ResearcherLink
from studyapp.models.researcher_login import ResearcherLogin
from studyapp.models.response import Response
from studyapp.models.screen_out import ScreenOut
from studyapp.models.study_session import StudySession
from studyapp.models.study_version import StudyVersion
from studyapp.models.trial import Trial
from studyapp.models.trial_stimulus import TrialStimulus
from studyapp.models.video import Video
from studyapp.models.watch_record import WatchRecord

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
