"""Making the motion of every generated condition."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from generators.interface import Generator, SpeechSegment
from generators.model_settings import ModelSettings
from generators.registry import generator_version, load_generator, needs_model
from motion.audio import read_audio
from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats import read_clip, write_clip
from motion.segment import Segment
from studyapp.definition.conditions import Condition
from studyapp.definition.folder import StudyFolder
from studyapp.definition.study import Study
from studyapp.stages.digest import digest


@dataclass(frozen=True)
class ConditionClips:
    """The clips of one condition, as a generator that starts from them sees them."""

    folder: StudyFolder
    condition: str
    segments: Sequence[Segment]

    def clip(self, segment_name: str) -> MotionClip:
        """Return the condition's clip of a segment."""
        path = self.folder.clip(self.condition, segment_name)
        if not path.exists():
            raise InputError(
                f"condition {self.condition!r} has no motion for segment {segment_name}",
                where=path,
                remedy="Bring it in with 'motionjury import', or give the condition a generator",
            )
        return read_clip(path)

    def paths_digest(self) -> str:
        """Return a digest of everything `clip` can give."""
        paths = [self.folder.clip(self.condition, segment.name) for segment in self.segments]
        return digest(*(path for path in paths if path.exists()))


@dataclass(frozen=True)
class GenerationCount:
    """How many clips a run made and how many were there already.

    Attributes
    ----------
    made, kept : int
        Clips.
    stand_ins : tuple of str
        What took the place of something real in a condition, with the condition's name.
    """

    made: int
    kept: int
    stand_ins: tuple[str, ...] = ()


def generate(
    folder: StudyFolder, *, on_clip: Callable[[int, int], None] = lambda done, total: None
) -> GenerationCount:
    """Make each generated clip that is missing or no longer fits its speech or settings.

    Parameters
    ----------
    folder : StudyFolder
        The study.
    on_clip : callable
        Called with (clips done, clips in all) after each clip.
    """
    study = folder.study()
    segments = folder.segments_of(study)
    conditions = study.generated()
    made = kept = 0
    stand_ins: list[str] = []
    for name, condition in conditions.items():
        maker = _ConditionMaker.of(folder, study, segments, name, condition)
        for segment in segments:
            if maker.make_if_needed(segment):
                made += 1
            else:
                kept += 1
            on_clip(made + kept, len(conditions) * len(segments))
        if needs_model(str(condition.generator)):
            clip = read_clip(folder.clip(name, segments[0].name))
            stand_ins += stood_in(name, clip)
    return GenerationCount(made=made, kept=kept, stand_ins=tuple(stand_ins))


def stood_in(name: str, clip: MotionClip) -> list[str]:
    """Return a line about what took the place of something real in `clip`, where something did."""
    found = clip.provenance.get("stand_ins")
    return [] if found is None else [f"{name}: {found}"]


def model_of(folder: StudyFolder, name: str, condition: Condition) -> ModelSettings | None:
    """Return the weights that condition `name` states, with paths from the study's folder.

    Raises
    ------
    InputError
        If one of its files is not there.
    """
    if condition.checkpoint is None:
        return None
    paths = (condition.stats, condition.hubert)
    stats, hubert = (None if path is None else folder.root / path for path in paths)
    try:
        return ModelSettings(
            checkpoint=folder.root / condition.checkpoint,
            dataset=condition.dataset or "beat",
            stats=stats,
            hubert=hubert,
            speaker=condition.speaker or 1,
        )
    except InputError as error:
        raise InputError(
            f"conditions.{name}: {error.what}", where=error.where, remedy=error.remedy
        ) from error


@dataclass(frozen=True, kw_only=True)
class _ConditionMaker:
    """Makes the clips of one condition."""

    folder: StudyFolder
    condition: str
    generator: Generator
    source: ConditionClips | None
    study_seed: int
    frame_rate: int
    inputs: str

    @classmethod
    def of(
        cls,
        folder: StudyFolder,
        study: Study,
        segments: Sequence[Segment],
        name: str,
        condition: Condition,
    ) -> _ConditionMaker:
        source = (
            ConditionClips(folder, condition.source, segments)
            if condition.source is not None
            else None
        )
        model = model_of(folder, name, condition)
        return cls(
            folder=folder,
            condition=name,
            generator=load_generator(str(condition.generator), model),
            source=source,
            study_seed=study.seed,
            frame_rate=study.video.frame_rate,
            inputs=digest(
                generator_version(str(condition.generator)),
                study.seed,
                study.video.frame_rate,
                source.paths_digest() if source else "",
                *(() if model is None else model.fingerprint()),
            ),
        )

    def make_if_needed(self, segment: Segment) -> bool:
        """Make the clip of `segment` unless the one that is there still fits; tell whether."""
        path = self.folder.clip(self.condition, segment.name)
        speech_file = self.folder.speech / segment.wav
        inputs = digest(self.inputs, segment, speech_file)
        if path.exists():
            made_from = read_clip(path).provenance.get("inputs")
            if made_from == inputs:
                return False
            if made_from is None:
                raise InputError(
                    f"this motion was imported, but condition {self.condition!r} has a generator",
                    where=path,
                    remedy="Remove the condition's generator from study.toml to use the file, or "
                    "move the file away to generate the motion",
                )
        speech = read_audio(speech_file)
        try:
            audio = speech.cut(segment.start, segment.end)
        except InputError as error:
            where = f"{speech_file}, segment {segment.name}"
            raise InputError(error.what, where=where, remedy=error.remedy) from error
        clip = self.generator.generate(
            SpeechSegment(segment=segment, audio=audio),
            seed=zlib.crc32(f"{self.study_seed}/{self.condition}/{segment.name}".encode()),
            frame_rate=self.frame_rate,
            source=self.source,
        )
        write_clip(path, clip.with_provenance(inputs=inputs))
        return True
