"""Endings of motion files, which `motion.formats` reads, and of speech, read by `motion.audio`."""

from typing import Final

MOTION_ENDINGS: Final = (".bvh", ".npz", ".npy")

SPEECH_ENDINGS: Final = (
    ".wav", ".flac", ".mp3", ".m4a", ".ogg", ".oga", ".opus", ".aif", ".aiff",
)  # fmt: skip
"""In order of preference."""

VIDEO_ENDING: Final = ".mp4"
