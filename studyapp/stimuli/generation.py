"""Generating the motion of a study's conditions, or of speech files without a study."""

import zlib
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

from generators.interface import OnPart, SpeechSegment
from generators.registry import load_generator, needs_model, needs_source
from generators.settings import Settings
from motion.audio import Audio, read_audio
from motion.clip import MotionClip
from motion.errors import InputError, found_at
from motion.files import digest
from motion.formats import read_clip, write_clip
from motion.placement import place
from motion.segment import Segment
from studyapp.study.folder import StudyFolder

OnClip = Callable[..., object]
"""Called with the numbers of finished clips and of all, and while one is made with a detail."""


def _show_parts(on_clip: OnClip, done: int, total: int, name: str) -> OnPart:
    """Return a function that shows the progress of the clip `name`, after `done` others."""

    def on_part(made: int, parts: int) -> None:
        on_clip(done, total, f"{name}: {100 * made // parts}%")

    return on_part


@dataclass(frozen=True)
class ConditionClips:
    """The clips of a condition, as the source of another condition."""

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
                remedy="Import it with 'motionjury import', or give the condition a generator",
            )
        return read_clip(path)

    def digest_clips(self) -> str:
        """Return a digest of all clips."""
        paths = [self.folder.clip(self.condition, segment.name) for segment in self.segments]
        return digest(*(path for path in paths if path.exists()))


@dataclass(frozen=True)
class GenerationCount:
    """The result of a run.

    Attributes
    ----------
    made, kept : int
        Clips made by this run, and existing ones that are up to date.
    remarks : tuple of str
        Sentences about the clips of a condition.
    """

    made: int
    kept: int
    remarks: tuple[str, ...] = ()


def generate(
    folder: StudyFolder, *, device: str = "cpu", on_clip: OnClip = lambda *_progress: None
) -> GenerationCount:
    """Generate all clips that are missing, or out of date with their speech or settings.

    Parameters
    ----------
    folder : StudyFolder
        The study.
    device : {'cpu', 'cuda'}
        Where networks run.
    on_clip : callable
        Called with (finished clips, all clips) after each clip, and with a detail while a network
        generates one.
    """
    study = folder.study()
    segments = folder.segments_of(study)
    conditions = study.generated()
    made = kept = 0
    total = len(conditions) * len(segments)
    for name, condition in conditions.items():
        try:
            settings = condition.settings.resolved_in(folder.root)
        except InputError as error:
            what = f"conditions.{name}: {error.what}"
            raise InputError(what, where=error.where, remedy=error.remedy) from error
        generator = load_generator(str(condition.generator), settings, device)
        source = ConditionClips(folder, condition.source, segments) if condition.source else None
        shared = digest(
            generator.name,
            generator.version,
            study.seed,
            study.video.frame_rate,
            source.digest_clips() if source else "",
            *settings.fingerprint(),
        )
        for segment in segments:
            path, speech = folder.clip(name, segment.name), folder.speech / segment.wav
            inputs = digest(shared, segment, speech)
            if _is_up_to_date(path, inputs, "remove the generator from study.toml to use it"):
                kept += 1
            else:
                clip = generator.generate(
                    SpeechSegment(segment=segment, audio=_excerpt(speech, segment)),
                    seed=zlib.crc32(f"{study.seed}/{name}/{segment.name}".encode()),
                    frame_rate=study.video.frame_rate,
                    source=source,
                    on_part=_show_parts(on_clip, made + kept, total, f"{name}/{segment.name}"),
                )
                write_clip(path, place(clip)[0].with_provenance(inputs=inputs))
                made += 1
            on_clip(made + kept, total)
    remarks = [
        _remarks(name, [folder.clip(name, segment.name) for segment in segments])
        for name, condition in conditions.items()
        if needs_model(str(condition.generator))
    ]
    return GenerationCount(made=made, kept=kept, remarks=tuple(chain.from_iterable(remarks)))


def _is_up_to_date(path: Path, inputs: str, other_way: str) -> bool:
    """Return whether the clip at `path` exists and was made from `inputs`.

    Raises
    ------
    InputError
        If the clip was not generated; the remedy names `other_way`.
    """
    if not path.exists():
        return False
    made_from = read_clip(path).provenance.get("inputs")
    if made_from is None:
        raise InputError(
            "this motion was not generated, and would be overwritten",
            where=path,
            remedy=f"Move it away, or {other_way}",
        )
    return made_from == inputs


def _excerpt(speech: Path, segment: Segment) -> Audio:
    recording = read_audio(speech)
    with found_at(f"{speech}, segment {segment.name}"):
        return recording.cut(segment.start, segment.end)


def _remarks(name: str, paths: Sequence[Path]) -> tuple[str, ...]:
    """Return a sentence on the stand-ins that the clips at `paths` were made with."""
    used = [read_clip(path).provenance.get("stand_ins", "").split("; ") for path in paths]
    stand_ins = dict.fromkeys(filter(None, chain.from_iterable(used)))
    return (f"Uses stand-ins: {name}: {'; '.join(stand_ins)}",) if stand_ins else ()


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
    on_clip: OnClip,
) -> GenerationCount:
    """Write a clip ``<out>/<name>.npz`` for each file of speech, unless it is up to date.

    Parameters
    ----------
    generator : str
        A generator that needs no source.
    settings : Settings
        Its settings.
    device : {'cpu', 'cuda'}
        Where a network runs.
    seed : int
        The seed of every clip, so that a clip does not depend on the other files.
    frame_rate : float
        Frame rate of the clips.
    emotion : str
        One of `motion.segment.EMOTIONS`, for generators that use it.
    on_clip : callable
        The same as for `generate`.

    Raises
    ------
    InputError
        If two files have the same name, a clip in `out` was not generated, the generator needs a
        source, or a file cannot be read.
    """
    if needs_source(generator):
        raise InputError(
            f"the generator {generator} changes another condition's motion",
            remedy="Use it in a study, or choose another generator",
        )
    repeated = [n for n, count in Counter(path.stem for path in speech).items() if count > 1]
    if repeated:
        raise InputError(
            f"two files of speech have the name {repeated[0]!r}",
            remedy="Generate them separately (--out)",
        )
    loaded = load_generator(generator, settings, device)
    shared = digest(
        loaded.name,
        loaded.version,
        seed,
        frame_rate,
        emotion,
        *settings.fingerprint(),
    )
    made = 0
    for number, path in enumerate(speech, start=1):
        target = out / f"{path.stem}.npz"
        inputs = digest(shared, path)
        if not _is_up_to_date(target, inputs, "choose another folder (--out)"):
            audio = read_audio(path)
            segment = Segment(
                name=path.stem,
                wav=path.name,
                start=0.0,
                end=audio.duration,
                speaker="unknown",
                emotion=emotion,
            )
            clip = loaded.generate(
                SpeechSegment(segment=segment, audio=audio),
                seed=seed,
                frame_rate=frame_rate,
                on_part=_show_parts(on_clip, number - 1, len(speech), path.stem),
            )
            write_clip(target, clip.with_provenance(inputs=inputs))
            made += 1
        on_clip(number, len(speech))
    clips = [out / f"{path.stem}.npz" for path in speech]
    remarks = _remarks(generator, clips)
    return GenerationCount(made=made, kept=len(speech) - made, remarks=remarks)
