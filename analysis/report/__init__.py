"""The report: one self-contained page that sets answers and metrics side by side."""

from analysis.report.inputs import KnownShare, ReportInputs
from analysis.report.writing import write_report

__all__ = ["KnownShare", "ReportInputs", "write_report"]
