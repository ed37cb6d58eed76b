"""Making the motion of every generated condition, and motion to speech files without a study."""

from __future__ import annotations

import zlib
from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from generators.interface import OnPart, SpeechSegment
from generators.registry import load_generator, needs_model, needs_source
from generators.settings import Settings
from motion.audio import Audio, read_audio
from motion.clip import MotionClip
from motion.errors import InputError
from motion.files import digest
from motion.formats import read_clip, write_clip
from motion.placement import place
from motion.segment import Segment
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.conditions import Condition


class OnClip(Protocol):
    """Shows how many clips are done, and how far the next one is."""

    def __call__(self, done: int, total: int, detail: str = "") -> None:
        """Show that `done` of `total` clips are made, and a `detail` behind."""
        ...


def unshown(done: int, total: int, detail: str = "") -> None:
    """Show nothing."""


def part_shown(on_clip: OnClip, done: int, total: int, name: str) -> OnPart:
    """Return what a generator tells how far the clip `name` is, `done` others being made."""

    def on_part(made: int, parts: int) -> None:
        on_clip(done, total, f"{name}: {100 * made // parts}%")

    return on_part


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
    remarks : tuple of str
        Sentences about what should be known of clips, with the condition's name.
    """

    made: int
    kept: int
    remarks: tuple[str, ...] = ()


def generate(
    folder: StudyFolder, *, device: str = "cpu", on_clip: OnClip = unshown
) -> GenerationCount:
    """Make each generated clip that is missing or no longer fits its speech or settings.

    Parameters
    ----------
    folder : StudyFolder
        The study.
    device : {'cpu', 'cuda'}
        Where networks run.
    on_clip : callable
        Called with (clips done, clips in all) after each clip, and with how far a clip is behind
        that while a network makes it.
    """
    study = folder.study()
    segments = folder.segments_of(study)
    conditions = study.generated()
    made = kept = 0
    total = len(conditions) * len(segments)
    remarks = Remarks()
    for name, condition in conditions.items():
        settings = settings_of(folder, name, condition)
        generator = load_generator(str(condition.generator), settings, device)
        source = ConditionClips(folder, condition.source, segments) if condition.source else None
        shared = digest(
            generator.name,
            generator.version,
            study.seed,
            study.video.frame_rate,
            source.paths_digest() if source else "",
            *settings.fingerprint(),
        )
        for segment in segments:
            path, speech = folder.clip(name, segment.name), folder.speech / segment.wav
            inputs = digest(shared, segment, speech)
            imported = InputError(
                f"this motion was imported, but condition {name!r} has a generator",
                where=path,
                remedy="Remove the condition's generator from study.toml to use the file, or move "
                "the file away to generate the motion",
            )
            if is_made_from(inputs, path, otherwise=imported):
                kept += 1
            else:
                clip = generator.generate(
                    SpeechSegment(segment=segment, audio=_excerpt(speech, segment)),
                    seed=zlib.crc32(f"{study.seed}/{name}/{segment.name}".encode()),
                    frame_rate=study.video.frame_rate,
                    source=source,
                    on_part=part_shown(on_clip, made + kept, total, f"{name}/{segment.name}"),
                )
                write_clip(path, place(clip)[0].with_provenance(inputs=inputs))
                made += 1
            on_clip(made + kept, total)
            if needs_model(str(condition.generator)):
                remarks.look_at(name, segment.name, path)
    return GenerationCount(made=made, kept=kept, remarks=remarks.sentences())


def is_made_from(inputs: str, path: Path, *, otherwise: InputError) -> bool:
    """Tell whether the clip at `path` is there and was made from `inputs`.

    Raises
    ------
    InputError
        `otherwise`, if no generator made it.
    """
    if not path.exists():
        return False
    made_from = read_clip(path).provenance.get("inputs")
    if made_from is None:
        raise otherwise
    return made_from == inputs


def _excerpt(speech: Path, segment: Segment) -> Audio:
    recording = read_audio(speech)
    try:
        return recording.cut(segment.start, segment.end)
    except InputError as error:
        where = f"{speech}, segment {segment.name}"
        raise InputError(error.what, where=where, remedy=error.remedy) from error


def settings_of(folder: StudyFolder, name: str, condition: Condition) -> Settings:
    """Return what condition `name` tells its generator, with paths from here.

    Raises
    ------
    InputError
        If one of its files is not there.
    """
    try:
        return condition.settings.resolved_in(folder.root)
    except InputError as error:
        raise InputError(
            f"conditions.{name}: {error.what}", where=error.where, remedy=error.remedy
        ) from error


class Remarks:
    """Collects what clips say of themselves, once for all clips of a condition that say it."""

    def __init__(self) -> None:
        self._stand_ins: dict[str, dict[str, None]] = defaultdict(dict)
        self._in_parts: dict[tuple[str, str], list[str]] = defaultdict(list)

    def look_at(self, condition: str, segment: str, path: Path) -> None:
        """Take down what the clip at `path` says of stand-ins and of how its speech was heard."""
        facts = read_clip(path).provenance
        for stand_in in facts.get("stand_ins", "").split("; "):
            if stand_in:
                self._stand_ins[condition].setdefault(stand_in)
        heard = facts.get("heard", "as a whole")
        if heard != "as a whole":
            self._in_parts[condition, heard].append(segment)

    def sentences(self) -> tuple[str, ...]:
        """Return a sentence for each thing to know."""
        stood_in = (
            f"Stands in for something real: {condition}: {'; '.join(found)}"
            for condition, found in self._stand_ins.items()
        )
        in_parts = (
            f"Long speech was heard {heard}: {condition}: {', '.join(segments)}"
            for (condition, heard), segments in self._in_parts.items()
        )
        return (*stood_in, *in_parts)


def generate_files(
    speech: Sequence[Path],
    out: Path,
    *,
    generator: str,
    settings: Settings,
    device: str,
    seed: int,
    frame_rate: float,
    emotion: str,
    on_clip: OnClip = unshown,
) -> GenerationCount:
    """Write a clip for each file of speech, ``<out>/<name>.npz``; clips that still fit are kept.

    Parameters
    ----------
    generator : str
        One that needs no source.
    settings : Settings
        What the generator takes besides speech.
    device : {'cpu', 'cuda'}
        Where a network runs.
    seed : int
        The same for all files; each is moved to as it would be alone.
    frame_rate : float
        Frames per second of the clips.
    emotion : str
        One of `motion.segment.EMOTIONS`, for generators that move by it.
    on_clip : callable
        As for `generate`.

    Raises
    ------
    InputError
        If two files would make one clip, a clip in `out` was made by something else, the
        generator starts from other motion, or a file cannot be read.
    """
    if needs_source(generator):
        raise InputError(
            f"the generator {generator} changes another condition's motion",
            remedy="Use it in a study, or name another generator",
        )
    twice = [name for name, count in Counter(path.stem for path in speech).items() if count > 1]
    if twice:
        raise InputError(
            f"two files of speech are called {twice[0]!r} and would make one clip",
            remedy="Give them separately, with another --out each",
        )
    moving = load_generator(generator, settings, device)
    shared = digest(
        moving.name,
        moving.version,
        seed,
        frame_rate,
        emotion,
        *settings.fingerprint(),
    )
    made = 0
    remarks = Remarks()
    for number, path in enumerate(speech, start=1):
        target = out / f"{path.stem}.npz"
        inputs = digest(shared, path)
        foreign = InputError(
            "this motion was made elsewhere and would be written over",
            where=target,
            remedy="Move it away, or name another --out",
        )
        if not is_made_from(inputs, target, otherwise=foreign):
            audio = read_audio(path)
            segment = Segment(
                name=path.stem,
                wav=path.name,
                start=0.0,
                end=audio.duration,
                speaker="unknown",
                emotion=emotion,
            )
            clip = moving.generate(
                SpeechSegment(segment=segment, audio=audio),
                seed=seed,
                frame_rate=frame_rate,
                on_part=part_shown(on_clip, number - 1, len(speech), path.stem),
            )
            write_clip(target, clip.with_provenance(inputs=inputs))
            made += 1
        remarks.look_at(generator, path.stem, target)
        on_clip(number, len(speech))
    return GenerationCount(made=made, kept=len(speech) - made, remarks=remarks.sentences())
