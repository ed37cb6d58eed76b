"""Motion files: the study's own, and those that researchers bring."""

from motion.formats.clip_npz import read_clip, write_clip

__all__ = ["read_clip", "write_clip"]
