"""The report: one self-contained page that sets answers and metrics side by side."""

from analysis.report.page import write_report
from analysis.report.subject import Subject

__all__ = ["Subject", "write_report"]
