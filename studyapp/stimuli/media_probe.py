"""Flaws and encoding of a video, found by opening it."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Final, Literal, Self

import av
from av.container import InputContainer

from motion.audio import WHOLE_FORMATS
from renderer.encoder import SOUND_RATE

_UNREADABLE: Final = (av.FFmpegError, OSError)

DURATION_TOLERANCE: Final = 0.1
"""Seconds by which a video may be longer or shorter than its segment."""


def _open(video: Path) -> InputContainer:
    return av.open(str(video), options=dict(WHOLE_FORMATS))


def _has_picture(container: InputContainer) -> bool:
    """Return whether a picture can be decoded, which fails for truncated files."""
    return any(stream.codec_context is not None for stream in container.streams.video[:1])


FlawKind = Literal["video-missing", "video-damaged", "sound-missing", "video-length"]


@dataclass(frozen=True)
class Flaw:
    """A flaw of a video: the name of its finding, and a predicate of the video."""

    kind: FlawKind
    what: str


def flaw_of(video: Path, seconds: float, *, sound: bool = True) -> Flaw | None:
    """Return the flaw of a video that should last `seconds`; None if there is none.

    Only the index and the first frame are read.

    Parameters
    ----------
    video : Path
        Any file.
    seconds : float
        The expected length, within `DURATION_TOLERANCE`.
    sound : bool
        Whether it must have sound.
    """
    if not video.is_file():
        return Flaw("video-missing", "is missing")
    try:
        with _open(video) as container:
            if "mp4" not in container.format.name:
                return Flaw("video-damaged", "is not an MP4 file")
            if not container.streams.video:
                return Flaw("video-damaged", "has no picture")
            if sound and not container.streams.audio:
                return Flaw("sound-missing", "has no sound")
            duration = (container.duration or 0) / av.time_base
            if abs(duration - seconds) > DURATION_TOLERANCE:
                return Flaw("video-length", f"lasts {duration:.2f} s, its segment {seconds:.2f} s")
            if next(container.decode(video=0), None) is None:
                return Flaw("video-damaged", "has no frame")
    except _UNREADABLE:
        return Flaw("video-damaged", "cannot be played: it is damaged or not a video")
    return None


@dataclass(frozen=True, kw_only=True)
class VideoFormat:
    """The encoding of a video, as far as browsers can tell.

    Attributes
    ----------
    width, height : int
        Pixels.
    frame_rate : float
        Frames per second.
    picture : str
        Codec, profile and pixel format.
    sound : str
        Codec, sample rate and channels; empty without sound.
    """

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
        """Why not every browser plays it; None if all do."""
        if not self.picture.startswith("h264") or not self.picture.endswith("420p"):
            return f"is encoded as {self.picture}, which not every browser plays"
        if self.sound and not self.sound.startswith("aac"):
            return f"has its sound as {self.sound}, which not every browser plays"
        return None

    @classmethod
    def rendered(cls, size: int, frame_rate: int) -> Self:
        """Return the format of rendered videos."""
        return cls(
            width=size,
            height=size,
            frame_rate=frame_rate,
            picture="h264 High yuv420p",
            sound=f"aac {SOUND_RATE} Hz mono",
        )


def format_of(video: Path) -> VideoFormat | None:
    """Return the encoding of a video; None if it cannot be opened or has no picture."""
    with suppress(*_UNREADABLE), _open(video) as container:
        if not _has_picture(container):
            return None
        picture: Any = container.streams.video[0]
        audio: Any = next(iter(container.streams.audio), None)
        sound = ""
        if audio is not None:
            sound = f"{audio.codec_context.name} {audio.sample_rate} Hz {audio.layout.name}"
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
    """What the index of a video reveals of its encoding; no browser shows it.

    Attributes
    ----------
    settings : bytes
        Configuration of the decoders of picture and sound.
    pictures : int
        Number of pictures.
    order : tuple of (int, bool)
        For each stored picture, its index in presentation order, and whether it is a keyframe.
    sounds : int
        Number of packets of sound.
    """

    WORDS: ClassVar[Mapping[str, str]] = {
        "settings": "settings of the encoder",
        "pictures": "how many pictures there are",
        "order": "which pictures are encoded from which others",
        "sounds": "how long the sound lasts",
    }
    """Should be the same in all videos shown side by side."""

    settings: bytes
    pictures: int
    order: tuple[tuple[int, bool], ...]
    sounds: int


def structure_of(video: Path) -> VideoStructure | None:
    """Return the structure of a video; None if it cannot be opened or has no picture."""
    with suppress(*_UNREADABLE), _open(video) as container:
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


def read_metadata(video: Path) -> tuple[str, ...]:
    """Return the metadata of a video's file: brands, titles, comments, names of streams."""
    try:
        with _open(video) as container:
            tables = [container.metadata, *(stream.metadata for stream in container.streams)]
    except _UNREADABLE:
        return ()
    return tuple(sorted(f"{key}: {value}" for table in tables for key, value in table.items()))
