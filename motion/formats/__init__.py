"""Motion files: the study's own, and those that researchers bring."""

from motion.formats.any_motion import read_motion
from motion.formats.clip_npz import read_clip, write_clip

__all__ = ["read_clip", "read_motion", "write_clip"]
