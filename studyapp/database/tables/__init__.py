"""The database tables; importing one of them imports all, for the metadata."""

from studyapp.database.tables import researchers, study_session, trial

__all__ = ["researchers", "study_session", "trial"]
