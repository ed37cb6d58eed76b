"""The report: one self-contained page that sets answers and metrics side by side."""

from analysis.report.content import Subject
from analysis.report.page import report_table, write_report

__all__ = ["Subject", "report_table", "write_report"]
