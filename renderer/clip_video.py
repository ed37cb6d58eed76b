"""A motion clip as a video with its speech, as lossless frames for pairs, or as single pictures."""

from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from motion.arrays import Floats32
from motion.body.model import BodyModel, read_body
from motion.body.surface import VertexNormals, surface_colours
from motion.clip import MotionClip
from motion.files import replacing
from motion.formats.clip_npz import read_clip
from renderer.contact_shadow import ContactShadow, ShadowCaster
from renderer.encoder import VideoWriter
from renderer.frames import FrameRenderer
from renderer.framing import Camera
from renderer.look import Look
from renderer.loudness import read_excerpt
from renderer.picture import SUPERSAMPLING, VIDEO, Canvas
from renderer.shown_clip import as_shown, frame_at
from renderer.video_jobs import ClipJob

FRAMES_AT_ONCE: Final = 16
"""Number of frames whose vertices are in memory together and that share a bounding box."""


class Stage:
    """A lit body and its camera, ready to render any number of clips.

    Parameters
    ----------
    body : Path
        A body model in SMPL-X's ``.npz`` layout.
    camera : Camera
        The study's camera.
    look : Look
        The study's look.
    """

    def __init__(self, body: Path, camera: Camera, look: Look) -> None:
        self.look = look
        self.body: BodyModel = read_body(body, expression_matrix=look.expression_matrix)
        self._normals = VertexNormals(self.body)
        self._caster = ShadowCaster(self.body)
        colours = surface_colours(self.body)
        self._renderer = FrameRenderer(self.body.faces, colours, camera, look.size, look.background)

    def __enter__(self) -> Self:
        self._renderer.__enter__()
        return self

    def __exit__(self, *raised: object) -> None:
        self._renderer.__exit__(*raised)

    def pictures(self, clip: MotionClip) -> Iterator[NDArray[np.uint8]]:
        """Yield each frame of `clip` as RGBA, `SUPERSAMPLING` times the look's size."""
        for batch in self._vertices(clip):
            for vertices, shadow in zip(batch, self._shadows(clip, batch), strict=True):
                planes = self._renderer.draw(vertices, self._normals.of(vertices), shadow=shadow)
                yield np.stack([*planes, np.full_like(planes[0], 255)], axis=2)

    def video_frames(self, clip: MotionClip) -> Iterator[Any]:
        """Yield each frame of `clip` as a downsampled `av.VideoFrame` in BT.709 yuv420p."""
        canvas = Canvas(self.look.size, self.look.background)
        for batch in self._vertices(clip):
            shadows = self._shadows(clip, batch)
            box = self._renderer.box_around([batch, *(s.corners() for s in shadows if s)])
            for vertices, shadow in zip(batch, shadows, strict=True):
                normals = self._normals.of(vertices)
                planes = self._renderer.draw(vertices, normals, box, shadow, VIDEO)
                yield canvas.video_frame(planes, box)

    def _shadows(self, clip: MotionClip, batch: Floats32) -> list[ContactShadow | None]:
        """Return the shadow in each frame of `batch`; None if the ground is not shown."""
        if self.look.framing != "full_body":
            return [None] * len(batch)
        ground = self._caster.ground(clip)
        return [self._caster.shadow(vertices, ground) for vertices in batch]

    def _vertices(self, clip: MotionClip) -> Iterator[Floats32]:
        """Yield the vertices of `FRAMES_AT_ONCE` frames at a time, shape (n, V, 3)."""
        for start in range(0, len(clip), FRAMES_AT_ONCE):
            yield self.body.vertices(clip, slice(start, start + FRAMES_AT_ONCE))


def write_clip_video(job: ClipJob, stage: Stage) -> None:
    """Write the video of one motion clip, its lossless frames, or both, each atomically.

    Parameters
    ----------
    job : ClipJob
        The clip and its speech.
    stage : Stage
        The stage that renders it; entered.

    Raises
    ------
    InputError
        If motion or speech cannot be read, or differ in length by more than
        `renderer.shown_clip.LENGTH_TOLERANCE`.
    """
    size, rate, duration = stage.look.size, stage.look.frame_rate, job.end - job.start
    clip = as_shown(read_clip(job.motion), stage.body, job.motion, duration, job.freeze, rate)
    sound = None
    if job.video is not None:
        sound = read_excerpt(job.speech, job.start, job.end)
    with ExitStack() as stack:
        writers = [
            stack.enter_context(
                VideoWriter(stack.enter_context(replacing(path)), size, size, rate, heard)
            )
            for path, heard in ((job.frames, None), (job.video, sound))
            if path is not None
        ]
        for frame in stage.video_frames(clip):
            for writer in writers:
                writer.write(frame)


def still(stage: Stage, clip: MotionClip, seconds: float) -> Image.Image:
    """Return the frame of `clip` that is shown at `seconds`, as RGB of the look's size."""
    return large_still(stage, frame_at(clip, seconds)).reduce(SUPERSAMPLING)


def large_still(stage: Stage, pose: MotionClip) -> Image.Image:
    """Return the first frame of `pose` as RGB, `SUPERSAMPLING` times the look's size."""
    picture = next(stage.pictures(pose))
    return Image.fromarray(picture[..., :3].copy())
