"""Whether a video is what it should be, and how it is encoded, found by opening it."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar, Final, Literal, Self

import av
from av.container import InputContainer

from motion.audio import WHOLE_FORMATS
from renderer.encoder import SOUND_RATE

_UNREADABLE: Final = (av.FFmpegError, OSError)

DURATION_TOLERANCE: Final = 0.1
"""Seconds by which a video may be longer or shorter than its segment."""


def _opened(video: Path) -> InputContainer:
    return av.open(str(video), options=dict(WHOLE_FORMATS))


def _has_picture(container: InputContainer) -> bool:
    """Tell whether a picture can be decoded; of a file that is cut off early, none can."""
    return any(stream.codec_context is not None for stream in container.streams.video[:1])


FlawKind = Literal["video-damaged", "sound-missing", "video-length"]


@dataclass(frozen=True)
class Flaw:
    """What is wrong with a video, as 'check' calls it, and in words that follow its name."""

    kind: FlawKind
    what: str


def flaw_of(video: Path, seconds: float, *, sound: bool = True) -> Flaw | None:
    """Return what is wrong with a video that should last `seconds`; None where nothing is.

    Its index is read and its first frame decoded, not the whole of it.

    Parameters
    ----------
    video : Path
        Any file.
    seconds : float
        May be missed by `DURATION_TOLERANCE`.
    sound : bool
        Whether it must have sound.
    """
    try:
        with _opened(video) as container:
            if "mp4" not in container.format.name:
                return Flaw("video-damaged", "is no MP4")
            if not container.streams.video:
                return Flaw("video-damaged", "has no picture")
            if sound and not container.streams.audio:
                return Flaw("sound-missing", "has no sound")
            lasts = (container.duration or 0) / av.time_base
            if abs(lasts - seconds) > DURATION_TOLERANCE:
                return Flaw("video-length", f"lasts {lasts:.2f} s, its segment {seconds:.2f} s")
            if next(container.decode(video=0), None) is None:
                return Flaw("video-damaged", "has no frame")
    except _UNREADABLE:
        return Flaw("video-damaged", "cannot be played: it is damaged or no video")
    return None


@dataclass(frozen=True, kw_only=True)
class VideoFormat:
    """How a video is encoded, as far as a browser can tell.

    Attributes
    ----------
    width, height : int
        Pixels.
    frame_rate : float
        Frames per second.
    picture : str
        Codec and profile, and how colours are stored.
    sound : str
        Codec, samples per second and channels; empty where there is none.
    """

    WORDS: ClassVar[Mapping[str, str]] = MappingProxyType(
        {
            "size": "the size of the picture",
            "frame_rate": "the number of frames per second",
            "picture": "how the picture is encoded",
            "sound": "how the sound is encoded",
        }
    )
    """What must be the same in videos that can stand beside each other."""

    width: int
    height: int
    frame_rate: float
    picture: str
    sound: str

    @property
    def size(self) -> str:
        """Width and height."""
        return f"{self.width} × {self.height}"

    @property
    def unplayable(self) -> str | None:
        """Why not every browser plays it; None where all do."""
        if not self.picture.startswith("h264") or not self.picture.endswith("420p"):
            return f"is encoded as {self.picture}, which not every browser plays"
        if self.sound and not self.sound.startswith("aac"):
            return f"has its sound as {self.sound}, which not every browser plays"
        return None

    @classmethod
    def rendered(cls, size: int, frame_rate: int) -> Self:
        """Return the format of the videos that are rendered."""
        return cls(
            width=size,
            height=size,
            frame_rate=frame_rate,
            picture="h264 High yuv420p",
            sound=f"aac {SOUND_RATE} Hz mono",
        )


def format_of(video: Path) -> VideoFormat | None:
    """Return how a video is encoded; None where it cannot be opened or has no picture."""
    with suppress(*_UNREADABLE), _opened(video) as container:
        if not _has_picture(container):
            return None
        picture: Any = container.streams.video[0]
        heard: Any = next(iter(container.streams.audio), None)
        sound = ""
        if heard is not None:
            sound = f"{heard.codec_context.name} {heard.sample_rate} Hz {heard.layout.name}"
        return VideoFormat(
            width=picture.width,
            height=picture.height,
            frame_rate=round(float(picture.guessed_rate or 0), 2),
            picture=f"{picture.codec_context.name} {picture.profile} {picture.pix_fmt}",
            sound=sound,
        )
    return None


@dataclass(frozen=True, kw_only=True)
class VideoStructure:
    """What the index of a video tells of how it was encoded; no browser shows it.

    Attributes
    ----------
    settings : bytes
        What decoders of picture and sound are set up with.
    pictures : int
        How many there are.
    order : tuple of (int, bool)
        Of each picture as they are stored: its place as they are shown, and whether it can be
        decoded on its own.
    sounds : int
        How many pieces the sound is encoded in; 0 without sound.
    """

    WORDS: ClassVar[Mapping[str, str]] = MappingProxyType(
        {
            "settings": "settings of the encoder",
            "pictures": "how many pictures there are",
            "order": "which pictures are encoded from which others",
            "sounds": "how long the sound lasts",
        }
    )
    """What should be the same in videos that can stand beside each other."""

    settings: bytes
    pictures: int
    order: tuple[tuple[int, bool], ...]
    sounds: int


def structure_of(video: Path) -> VideoStructure | None:
    """Return what the index of a video tells; None where it cannot be opened or has no picture."""
    with suppress(*_UNREADABLE), _opened(video) as container:
        if not _has_picture(container):
            return None
        streams: list[Any] = [*container.streams.video[:1], *container.streams.audio[:1]]
        packets: list[Any] = [p for p in container.demux(streams) if p.pts is not None]
        pictures = [packet for packet in packets if packet.stream is streams[0]]
        shown = {pts: place for place, pts in enumerate(sorted(p.pts for p in pictures))}
        return VideoStructure(
            settings=b" ".join(s.codec_context.extradata or b"" for s in streams),
            pictures=len(pictures),
            order=tuple((shown[packet.pts], packet.is_keyframe) for packet in pictures),
            sounds=len(packets) - len(pictures),
        )
    return None


def written_in(video: Path) -> tuple[str, ...]:
    """Return what a video's file says of itself: brands, titles, comments, names of streams."""
    try:
        with _opened(video) as container:
            tables = [container.metadata, *(stream.metadata for stream in container.streams)]
    except _UNREADABLE:
        return ()
    said = [f"{key}: {value}" for table in tables for key, value in table.items()]
    return tuple(sorted(said))
