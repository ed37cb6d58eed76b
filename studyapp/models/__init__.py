"""The database tables, one a file."""

from studyapp.models.base import Base
from studyapp.models.place import Place
from studyapp.models.response import Response
from studyapp.models.study_session import StudySession
from studyapp.models.trial import Trial
from studyapp.models.watch_batch import WatchBatch

__all__ = ["Base", "Place", "Response", "StudySession", "Trial", "WatchBatch"]
