"""What the pixels of a video depend on, as one short text."""

from __future__ import annotations

from typing import Final

from motion.source_version import source_version

BODY_VERSION: Final = source_version(
    ("renderer/avatars.py", "renderer/avatar/*.py", "motion/skeleton.py", "motion/face.py"),
    ("anny",),
)
"""Changes whenever the default body would."""

RENDERER_VERSION: Final = source_version(
    (
        "renderer/*.py",
        "renderer/avatar/*.py",
        "renderer/shaders/*",
        "motion/body.py",
        "motion/freeze.py",
        "motion/resample.py",
    ),
    ("anny", "av", "pyrender"),
)
"""Changes whenever the pixels or the sound of a video would, and sometimes when they would not."""
