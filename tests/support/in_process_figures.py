"""Figures that a test computes in this process, on demand."""

from collections.abc import Callable
from dataclasses import dataclass, field

from motion.errors import InputError
from studyapp.researchers.interim_figures import TIMEOUT_SECONDS, FigureKind, FigureProcess
from studyapp.results.looks import figures_so_far
from studyapp.side_process import SideProcessError
from studyapp.study.folder import StudyFolder


@dataclass(frozen=True)
class InProcessFigures(FigureProcess):
    begun: list[Callable[[], None]] = field(default_factory=list)

    def begin(self, job: Callable[[], None]) -> None:
        self.begun.append(job)

    def work(self) -> int:
        """Do what has been begun, and return how much that was."""
        count = len(self.begun)
        while self.begun:
            self.begun.pop(0)()
        return count

    def compute(self, what: FigureKind, *, seconds: float = TIMEOUT_SECONDS) -> str:
        del seconds
        try:
            return figures_so_far(StudyFolder(self.folder), what).model_dump_json()
        except InputError as error:
            raise SideProcessError(str(error)) from error
