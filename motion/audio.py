"""Speech as samples: any common audio format in, mono float samples out."""

from __future__ import annotations

import io
import math
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, Self, cast

import numpy as np
import soundfile

from motion.arrays import Floats, Floats32
from motion.errors import InputError, found_at
from motion.files import replacing
from motion.segment import excerpt_bounds

# PyAV is imported where it is used: every command knows this module, and few read audio.
if TYPE_CHECKING:
    from av.audio.frame import AudioFrame
    from av.container import InputContainer

SPEECH_RATE: Final = 16000
"""Samples per second that speech is analysed at."""

LONGEST: Final = 3 * 3600
"""Longest recording accepted, in seconds; a small file can unpack to more than memory holds."""

WHOLE_FORMATS: Final = MappingProxyType(
    {
        "format_whitelist": "aac,aiff,amr,asf,au,avi,caf,flac,matroska,mov,mp3,mpeg,mpegts,ogg,"
        "w64,wav,webm"
    }
)
"""Options that keep FFmpeg from opening playlists, which would make it read other files."""

_RIFF_TOLERANCE: Final = 4096
_RIFF_SIZES_OF_STREAMS: Final = frozenset({0, 0xFFFFFFFF})
_FORMAT_OF_ENDING: Final = MappingProxyType(
    {
        ".wav": "wav",
        ".mp3": "mp3",
        ".flac": "flac",
        ".ogg": "ogg",
        ".oga": "ogg",
        ".opus": "ogg",
        ".m4a": "mp4",
        ".mp4": "mp4",
        ".mov": "mov",
        ".webm": "webm",
        ".aif": "aiff",
        ".aiff": "aiff",
    }
)


@dataclass(frozen=True, eq=False)
class Audio:
    """Mono audio.

    Attributes
    ----------
    samples : ndarray, shape (N,), float32
        Amplitudes in [-1, 1], N > 0.
    sample_rate : int
        Samples per second.
    notes : tuple of str
        Remarks on how the samples were read.

    Raises
    ------
    InputError
        If the samples are empty, not finite or not mono.
    """

    samples: Floats32
    sample_rate: int
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        samples = np.array(self.samples, dtype=np.float32)
        if samples.ndim != 1 or not samples.size:
            raise InputError(
                f"audio samples have shape {samples.shape}", remedy="Give mono audio with sound"
            )
        if not np.isfinite(samples).all():
            raise InputError(
                "the audio holds a sample that is not a number", remedy="Export the audio again"
            )
        samples.setflags(write=False)
        object.__setattr__(self, "samples", samples)

    @property
    def duration(self) -> float:
        """Length in seconds."""
        return len(self.samples) / self.sample_rate

    def samples_at(self, sample_rate: int) -> Floats:
        """Return the samples at another rate, low-pass filtered if it is lower."""
        # Imported here: it takes a moment to load, and most audio is read at the rate it needs.
        from scipy.signal import resample_poly

        samples = self.samples.astype(np.float64)
        if sample_rate == self.sample_rate:
            return samples
        common = math.gcd(sample_rate, self.sample_rate)
        return np.asarray(resample_poly(samples, sample_rate // common, self.sample_rate // common))

    def cut(self, start: float, end: float) -> Self:
        """Return the excerpt from `start` to `end`.

        Parameters
        ----------
        start, end : float
            Seconds, ``0 <= start < end``. If `end` is past the audio by no more than
            `motion.segment.CUT_TOLERANCE`, the excerpt is padded with silence: it always has
            ``round((end - start) * sample_rate)`` samples.

        Raises
        ------
        InputError
            If the excerpt is empty or lies outside the audio.
        """
        first, count = excerpt_bounds(start, end, rate=self.sample_rate, length=len(self.samples))
        excerpt = np.zeros(count, np.float32)
        overlap = self.samples[first : first + count]
        excerpt[: len(overlap)] = overlap
        return type(self)(excerpt, self.sample_rate, self.notes)


def read_audio(path: Path, *, sample_rate: int | None = SPEECH_RATE) -> Audio:
    """Read the first audio stream of any file that FFmpeg can read, whatever its ending.

    Parameters
    ----------
    path : Path
        An audio or video file.
    sample_rate : int or None
        Samples per second of the result; None keeps the file's own.

    Returns
    -------
    Audio
        All channels averaged to one. Its notes name a file ending that contradicts the
        content, and a level above full scale, which is scaled down.

    Raises
    ------
    InputError
        If the file is missing, has no readable audio, is shorter than its header declares, or
        lasts longer than `LONGEST`.
    """
    import av

    path = Path(path)
    if not path.is_file():
        raise InputError("there is no such audio file", where=path, remedy="Check the path")
    _check_whole_wav(path)
    try:
        with av.open(str(path), options=dict(WHOLE_FORMATS)) as container:
            if not container.streams.audio:
                raise InputError(
                    "the file has no audio stream",
                    where=path,
                    remedy="Give a file with speech in it",
                )
            format_names = tuple(container.format.name.split(","))
            samples, rate = _decode(container, sample_rate, path)
    except (av.FFmpegError, ValueError) as error:
        raise InputError(
            f"the file is damaged or cannot be read as audio ({error.__class__.__name__})",
            where=path,
            remedy="Give a WAV, FLAC, MP3, OGG or M4A file that plays in a media player",
        ) from error
    notes = _ending_notes(path, format_names)
    peak = float(np.abs(samples).max(initial=0))
    if 1 < peak < math.inf:
        samples = samples / np.float32(peak)
        notes += (f"{path.name} peaks at {peak:.2f} of full scale; scaled down to 1",)
    with found_at(path):
        return Audio(samples, rate, notes)


def _check_whole_wav(path: Path) -> None:
    """Raise if a WAV is shorter than its header declares; FFmpeg would read it silently."""
    with path.open("rb") as file:
        header = file.read(8)
    if len(header) < 8 or header[:4] != b"RIFF":
        return
    declared = int.from_bytes(header[4:], "little")
    available = path.stat().st_size - len(header)
    if declared not in _RIFF_SIZES_OF_STREAMS and available < declared - _RIFF_TOLERANCE:
        raise InputError(
            f"the file is truncated: its header promises {declared} bytes, it holds {available}",
            where=path,
            remedy="Copy or export it again",
        )


def _decode(container: InputContainer, sample_rate: int | None, path: Path) -> tuple[Floats32, int]:
    """Return the channel-averaged samples of the first audio stream, and their rate."""
    from av.audio.resampler import AudioResampler

    stream = container.streams.audio[0]
    rate = sample_rate or stream.rate
    # Interleaved, since PyAV crashes on planes of eight and more channels.
    resampler = AudioResampler(format="flt", rate=rate)
    chunks: list[Floats32] = []
    seconds = 0.0
    for frame in container.decode(stream):
        seconds += frame.samples / frame.sample_rate
        if seconds > LONGEST:
            raise InputError(
                f"the recording lasts longer than {LONGEST / 3600:.0f} hours",
                where=path,
                remedy="Cut it into shorter files",
            )
        chunks.extend(_mono(resampled) for resampled in resampler.resample(frame))
    if chunks:
        chunks.extend(_mono(resampled) for resampled in resampler.resample(None))
    return (np.concatenate(chunks) if chunks else np.zeros(0, np.float32)), rate


def _mono(frame: AudioFrame) -> Floats32:
    # FFmpeg's own mixdown of float audio adds the channels up, which overflows full scale.
    channels = frame.to_ndarray().reshape(-1, frame.layout.nb_channels)
    return cast("Floats32", channels.mean(axis=1, dtype=np.float32))


def _ending_notes(path: Path, format_names: tuple[str, ...]) -> tuple[str, ...]:
    """Return a note if the file's ending contradicts its content."""
    expected = _FORMAT_OF_ENDING.get(path.suffix.lower())
    if expected is None or expected in format_names:
        return ()
    return (f"{path.name} is really {format_names[0].upper()}, not {path.suffix[1:].upper()}",)


def write_wav(path: Path, audio: Audio) -> None:
    """Write `audio` to `path` as 16-bit PCM WAV, whole or not at all."""
    # Not straight into the file: soundfile does not report a full disk.
    content = io.BytesIO()
    soundfile.write(content, audio.samples, audio.sample_rate, format="WAV", subtype="PCM_16")
    with replacing(path) as draft:
        draft.write_bytes(content.getbuffer())
