"""What the pixels and the sound of a video depend on, as one short text."""

from __future__ import annotations

from typing import Final

from motion.source_version import imported_sources, source_version

BODY_SOURCES: Final = imported_sources(["renderer.avatar.assembly"])
"""All code that the default body is built by."""

VIDEO_SOURCES: Final = imported_sources(["renderer.clip_video", "renderer.dub", "renderer.pair"])
"""All code that draws, composes, encodes and sounds; a body's file is told by its own name."""

BODY_VERSION: Final = source_version(BODY_SOURCES, ("anny",))
"""Changes whenever the default body would."""

RENDERER_VERSION: Final = source_version(
    (*VIDEO_SOURCES, "renderer/shaders/*"), ("av", "pillow", "pyrender")
)
"""Changes whenever the pixels or the sound of a video would, and sometimes when they would not."""
