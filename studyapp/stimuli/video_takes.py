"""Takes for training, from an ordinary video of a speaker."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from motion.audio import read_audio, write_wav
from motion.body.model import read_body
from motion.errors import InputError
from motion.formats import write_clip
from motion.points.detection import Detection, Stretch, detect, stretches
from motion.points.found_motion import clip_from_detection
from motion.segment import check_name
from renderer.look import default_body
from training.data.found_take import usable_name

_SOUND_TOLERANCE: Final = 0.1
"""Seconds by which a video may outlast its sound without a note."""


@dataclass(frozen=True, kw_only=True)
class VideoTakes:
    """The takes of a video.

    Attributes
    ----------
    takes : tuple of str
        Their names.
    seconds : float
        Their total length.
    notes : tuple of str
        What was left out or changed, for the researcher.
    """

    takes: tuple[str, ...]
    seconds: float
    notes: tuple[str, ...]


def import_video(
    video: Path, folder: Path, *, speaker: str | None, on_frame: Callable[[int, int], None]
) -> VideoTakes:
    """Store each stretch of a video that shows a person as a take in `folder`.

    Nothing is written before everything was detected and checked.

    Parameters
    ----------
    video : Path
        A video with sound.
    folder : Path
        Created if needed; may hold takes of other videos. A take is ``SPEAKER/VIDEO_01.npz`` and
        ``.wav``.
    speaker : str or None
        The speaker's name; by default the video's name.
    on_frame : callable
        Called with (processed frames, all frames).

    Raises
    ------
    InputError
        If the video cannot be read, has no sound, shows no face for long enough, or takes of the
        same name exist.
    """
    if (folder / "study.toml").exists():
        raise InputError(
            "this is a study folder",
            where=folder,
            remedy="Choose another folder for takes; import single takes into the study",
        )
    speaker = usable_name(video.stem) if speaker is None else speaker
    check_name(speaker, "speaker")
    try:
        audio = read_audio(video, sample_rate=None)
    except InputError as error:
        raise InputError(
            error.what, where=video, remedy="Export the video with its sound as MP4 (H.264, AAC)"
        ) from error
    detection = detect(video, on_frame)
    parts = _parts(detection, audio.duration)
    usable = [part for part in parts if not part.reason]
    if not usable:
        raise InputError(
            f"no part of the video can be used: {_reasons(parts)}",
            where=video,
            remedy="Use a video that shows the face and upper body of one person",
        )
    files = [
        folder / speaker / f"{usable_name(f'{video.stem}_{number:02d}')}.npz"
        for number in range(1, len(usable) + 1)
    ]
    for file in files:
        if file.exists():
            raise InputError(
                "a take of this name exists",
                where=file,
                remedy="Rename the video, or remove its takes first",
            )
    body = read_body(default_body())
    clips = [
        clip_from_detection(detection.stretch(part.start, part.end), body).with_provenance(
            source=video.name, format="video (MediaPipe)"
        )
        for part in usable
    ]
    rate = detection.frame_rate
    for file, part, clip in zip(files, usable, clips, strict=True):
        sound = audio.cut(part.start / rate, part.end / rate)
        write_wav(file.with_suffix(".wav"), replace(sound, notes=()))
        write_clip(file, clip)
    left_out = [part for part in parts if part.reason]
    notes = [
        *audio.notes,
        *(
            f"left out {part.start / rate:.1f} to {part.end / rate:.1f} s: {part.reason}"
            for part in left_out
        ),
        *(
            f"{file.stem}: {note}"
            for file, clip in zip(files, clips, strict=True)
            if (note := clip.provenance.get("notes"))
        ),
    ]
    return VideoTakes(
        takes=tuple(file.stem for file in files),
        seconds=sum(clip.duration for clip in clips),
        notes=tuple(notes),
    )


def _parts(detection: Detection, seconds: float) -> tuple[Stretch, ...]:
    """Return the parts of a video with `seconds` of sound."""
    frames = min(len(detection), int(seconds * detection.frame_rate + 1e-6))
    parts = [
        replace(part, end=min(part.end, frames))
        for part in stretches(detection)
        if part.start < frames
    ]
    if len(detection) - frames > _SOUND_TOLERANCE * detection.frame_rate:
        parts.append(Stretch(start=frames, end=len(detection), reason="no sound"))
    return tuple(parts)


def _reasons(parts: Sequence[Stretch]) -> str:
    """Return why the parts are left out, the most frequent reason first."""
    frames: Counter[str] = Counter()
    for part in parts:
        frames[part.reason] += part.end - part.start
    total = max(frames.total(), 1)
    return ", ".join(f"{why} in {100 * count / total:.0f}%" for why, count in frames.most_common())
