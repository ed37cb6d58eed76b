"""The report: one self-contained page that sets answers and metrics side by side."""

from analysis.report.inputs import ReportInputs
from analysis.report.writing import write_report

__all__ = ["ReportInputs", "write_report"]
