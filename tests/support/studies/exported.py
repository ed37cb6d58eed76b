"""The tables of an export, read from one state of a database."""

import pandas as pd
from sqlalchemy.orm import Session

from studyapp.results.export.rows import answers_table, participants_table
from studyapp.results.stored_answers import stored_answers


def responses_table(session: Session, *, withdrawn: bool = False) -> pd.DataFrame:
    """Return every answer, or every kept one of withdrawn participants."""
    return answers_table(stored_answers(session, withdrawn=withdrawn, in_full=True))


def study_sessions_table(session: Session) -> pd.DataFrame:
    """Return every study session."""
    return participants_table(stored_answers(session, in_full=True))
