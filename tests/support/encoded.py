"""Videos as other tools write them, with metadata, and what videos show."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from av.audio.stream import AudioStream
from av.video.stream import VideoStream
from numpy.typing import NDArray

from motion.arrays import Floats32
from motion.audio import Audio
from renderer.encoder import SOUND_RATE
from tests.support.sounds import tone


@dataclass(frozen=True, kw_only=True)
class VideoRecipe:
    """What a video holds, and the metadata of its file.

    Attributes
    ----------
    name, language : str
        Written into the file's and its streams' metadata.
    tags : mapping of str to str
        More metadata of the file.
    encoder, layout : mapping of str to str
        Settings of the encoder of the picture, and of how the file is laid out.
    sound : Audio or None
        The sound; by default two seconds of a tone.
    sound_bits : int or None
        Bits a second of the sound; by default the library's.
    """

    name: str = ""
    language: str = "und"
    tags: Mapping[str, str] = field(default_factory=dict)
    frames: int = 60
    rate: int = 30
    size: int = 64
    codec: str = "libx264"
    encoder: Mapping[str, str] = field(default_factory=dict)
    layout: Mapping[str, str] = field(default_factory=dict)
    sound: Audio | None = field(default_factory=lambda: tone(2, 300, SOUND_RATE, 0.1))
    sound_bits: int | None = None


def write_video(
    path: Path, recipe: VideoRecipe, pictures: Iterable[NDArray[np.uint8]] | None = None
) -> None:
    """Write a video of `pictures`, (size, size, 3); by default of a grey that grows lighter."""
    if pictures is None:
        shades = (60 + 2 * index % 180 for index in range(recipe.frames))
        pictures = (np.full((recipe.size, recipe.size, 3), shade, np.uint8) for shade in shades)
    path.parent.mkdir(parents=True, exist_ok=True)
    with av.open(str(path), "w", options=dict(recipe.layout)) as container:
        container.metadata.update({"title": recipe.name, "comment": recipe.name, **recipe.tags})
        video = container.add_stream(recipe.codec, rate=recipe.rate, options=dict(recipe.encoder))
        assert isinstance(video, VideoStream)
        video.width, video.height, video.pix_fmt = recipe.size, recipe.size, "yuv420p"
        video.metadata.update({"language": recipe.language, "handler_name": recipe.name})
        packets = []
        if recipe.sound is not None:
            audio = container.add_stream("aac", rate=SOUND_RATE, layout="mono")
            assert isinstance(audio, AudioStream)
            if recipe.sound_bits is not None:
                audio.bit_rate = recipe.sound_bits
            frame = av.AudioFrame.from_ndarray(
                np.ascontiguousarray(recipe.sound.samples[None]), format="fltp", layout="mono"
            )
            frame.sample_rate, frame.pts = SOUND_RATE, 0
            frame.time_base = Fraction(1, SOUND_RATE)
            packets = [*audio.encode(frame), *audio.encode(None)]
        for picture in pictures:
            container.mux(video.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        container.mux(video.encode(None))
        container.mux(packets)


def pictures_of(video: Path) -> NDArray[np.uint8]:
    """Return the frames of a video, (frames, height, width, 3)."""
    with av.open(str(video)) as container:
        return np.array([frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)])


def sound_of(video: Path) -> Floats32:
    """Return the samples of a video's sound."""
    with av.open(str(video)) as container:
        return np.concatenate([frame.to_ndarray()[0] for frame in container.decode(audio=0)])
