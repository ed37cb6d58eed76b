"""Where everything lies in a study's folder."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from motion.errors import InputError
from motion.segment import Segment
from motion.segments_table import read_segments
from studyapp.study.finished_videos import finished_segments
from studyapp.study.settings.reading import read_study
from studyapp.study.settings.study import Study


@dataclass(frozen=True)
class StudyFolder:
    """The paths of one study; making one touches no disk."""

    root: Path

    @property
    def definition(self) -> Path:
        """The study file."""
        return self.root / "study.toml"

    @property
    def speech(self) -> Path:
        """Folder of ``segments.csv`` and the recordings it names."""
        return self.root / "speech"

    @property
    def videos(self) -> Path:
        """Folder of the rendered media."""
        return self.root / "videos"

    @property
    def stimuli(self) -> Path:
        """What each rendered file is."""
        return self.root / "stimuli.json"

    @property
    def responses(self) -> Path:
        """SQLite database of real participants."""
        return self.root / "responses.db"

    @property
    def rehearsal(self) -> Path:
        """SQLite database of simulated participants; never mixed with the real one."""
        return self.root / "rehearsal.db"

    @property
    def tries(self) -> Path:
        """SQLite database of test participations; never mixed with the real one."""
        return self.root / "tries.db"

    @property
    def rehearsal_truth(self) -> Path:
        """What the simulated participants were given to prefer."""
        return self.root / "rehearsal.json"

    @property
    def rehearsal_findings(self) -> Path:
        """Folder of what a rehearsal's participants were told, and of what came of it."""
        return self.root / "rehearsal"

    @property
    def acknowledged(self) -> Path:
        """What the simulated participants were told is stored, line by line."""
        return self.rehearsal_findings / "acknowledged.jsonl"

    @property
    def pseudonym_key(self) -> Path:
        """Key of the participants' pseudonyms; it is never exported."""
        return self.root / "pseudonyms.key"

    @property
    def shared_answers(self) -> Path:
        """Folder of answers that another lab has passed on, in place of a database."""
        return self.root / "shared_answers"

    @property
    def report(self) -> Path:
        """Folder of the report."""
        return self.root / "report"

    @property
    def figures(self) -> Path:
        """Folder of figures for a paper; they name conditions and are never served."""
        return self.root / "figures"

    @property
    def joint_positions(self) -> Path:
        """Folder in which metrics keep what they computed; it may be removed at any time."""
        return self.root / ".joint-positions"

    @property
    def evaluators(self) -> Path:
        """Folder of feature networks with which metrics measure, ``*.safetensors``."""
        return self.root / "evaluators"

    @property
    def metrics(self) -> Path:
        """Automatic metrics, by condition and by clip."""
        return self.root / "metrics.parquet"

    def clip(self, condition: str, segment: str) -> Path:
        """Return the motion clip of `condition` for `segment`."""
        return self.root / "motion" / condition / f"{segment}.npz"

    def semantics(self, segment: str) -> Path:
        """Return the semantic scores of a recording's gestures, as BEAT annotates them."""
        return self.speech / f"{segment}.txt"

    def study(self) -> Study:
        """Read and validate the study file."""
        return read_study(self.definition)

    def segments(self) -> Sequence[Segment]:
        """Read the segments; a study without any is an error that says what to do."""
        if not (self.speech / "segments.csv").exists():
            raise InputError(
                "the study has no speech yet",
                where=self.speech / "segments.csv",
                remedy="Bring recordings in with 'motionjury import'",
            )
        return read_segments(self.speech)

    def segments_of(self, study: Study) -> Sequence[Segment]:
        """Read the segments of `study`, as `segments` does.

        A study of finished videos alone needs no speech files: without them, its segments are
        those that the videos are named after. A study that allows gaps has only segments that
        every condition with finished videos has one of.
        """
        finished = [name for name, condition in study.conditions.items() if condition.videos]
        if len(finished) == len(study.conditions) and not (self.speech / "segments.csv").exists():
            return finished_segments(self.videos, finished, allow_gaps=study.allow_gaps)
        segments = self.segments()
        if not study.allow_gaps:
            return segments
        return [
            segment
            for segment in segments
            if all((self.videos / name / f"{segment.name}.mp4").is_file() for name in finished)
        ]
