"""The report: one self-contained page that sets answers and metrics side by side."""

from analysis.report.subject import Subject
from analysis.report.writing import write_report

__all__ = ["Subject", "write_report"]
