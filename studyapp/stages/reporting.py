"""The report of a study: its answers, its motions, and what to say about both."""

from __future__ import annotations

from pathlib import Path

from analysis.report import write_report
from studyapp.definition.folder import StudyFolder


def report(folder: StudyFolder) -> Path:
    """Write the report of `folder` and return its page.

    Real answers are used where there are any, else those of the rehearsal; they are never
    mixed, and the report says which it shows.
    """
    study = folder.study()
    return write_report(_inputs(folder, study), folder.report)
