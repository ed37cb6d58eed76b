"""Motion to speech files, without a study."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from generators.interface import SpeechSegment
from generators.registry import load_generator, needs_source
from generators.settings import Settings
from motion.audio import read_audio
from motion.errors import InputError
from motion.formats import write_clip
from motion.segment import Segment
from studyapp.stimuli.digest import digest
from studyapp.stimuli.generation import (
    GenerationCount,
    OnClip,
    Remarks,
    is_made_from,
    part_shown,
    unshown,
)


@dataclass(frozen=True, kw_only=True)
class FileMotion:
    """How files of speech are moved to.

    Attributes
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
    """

    generator: str
    settings: Settings
    device: str
    seed: int
    frame_rate: float
    emotion: str


def generate_files(
    speech: Sequence[Path],
    out: Path,
    how: FileMotion,
    *,
    on_clip: OnClip = unshown,
) -> GenerationCount:
    """Write a clip for each file of speech, ``<out>/<name>.npz``; clips that still fit are kept.

    Raises
    ------
    InputError
        If two files would make one clip, a clip in `out` was made by something else, the
        generator starts from other motion, or a file cannot be read.
    """
    if needs_source(how.generator):
        raise InputError(
            f"the generator {how.generator} changes another condition's motion",
            remedy="Use it in a study, or name another generator",
        )
    twice = [name for name, count in Counter(path.stem for path in speech).items() if count > 1]
    if twice:
        raise InputError(
            f"two files of speech are called {twice[0]!r} and would make one clip",
            remedy="Give them separately, with another --out each",
        )
    generator = load_generator(how.generator, how.settings, how.device)
    settings = digest(
        generator.name,
        generator.version,
        how.seed,
        how.frame_rate,
        how.emotion,
        *how.settings.fingerprint(),
    )
    made = 0
    remarks = Remarks()
    for number, path in enumerate(speech, start=1):
        target = out / f"{path.stem}.npz"
        inputs = digest(settings, path)
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
                emotion=how.emotion,
            )
            clip = generator.generate(
                SpeechSegment(segment=segment, audio=audio),
                seed=how.seed,
                frame_rate=how.frame_rate,
                on_part=part_shown(on_clip, number - 1, len(speech), path.stem),
            )
            write_clip(target, clip.with_provenance(inputs=inputs))
            made += 1
        remarks.look_at(how.generator, path.stem, target)
        on_clip(number, len(speech))
    return GenerationCount(made=made, kept=len(speech) - made, remarks=remarks.sentences())
