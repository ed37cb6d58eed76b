"""How far the figure's outline is from one averaged over many samples a pixel."""

from __future__ import annotations

import importlib
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.body.surface import VertexNormals, surface_colours
from renderer.clip_video import Stage
from renderer.frames import PLANES, FrameRenderer
from renderer.framing import Camera
from renderer.look import BACKGROUND
from renderer.picture import RGB, SUPERSAMPLING, PixelBox

Pictures = NDArray[np.float64]

_REFERENCE: Final = 6
"""Each side of a pixel of the reference has this many samples."""


def edge_errors(stage: Stage, camera: Camera, vertices: NDArray[np.float32]) -> tuple[float, float]:
    """Return how far our outline, and that of 4 × multisampling, is from the reference.

    Parameters
    ----------
    stage : Stage
        Gives body and look; not entered, as each measurement has a context of its own.
    camera : Camera
        The camera.
    vertices : ndarray, shape (V, 3)
        One frame.

    Returns
    -------
    tuple of float
        Root mean square in grey levels over the pixels that the outline crosses.
    """
    normals = VertexNormals(stage.body).of(vertices)
    colours = surface_colours(stage.body)
    size = stage.look.size

    def renderer(side: int) -> FrameRenderer:
        return FrameRenderer(stage.body.faces, colours, camera, side // SUPERSAMPLING)

    with renderer(size * _REFERENCE) as drawing:
        fine = np.moveaxis(drawing.draw(vertices, normals), 0, 2).astype(np.float64)
    with renderer(size * SUPERSAMPLING) as drawing:
        ours = _averaged(np.moveaxis(drawing.draw(vertices, normals), 0, 2), SUPERSAMPLING)
    with renderer(size) as drawing:
        multisampled = _multisampled(drawing, vertices, normals, samples=4)
    empty = (fine == BACKGROUND).all(axis=2).astype(np.float64)[..., None]
    share = _averaged(empty, _REFERENCE)[..., 0]
    outline = (share > 0) & (share < 1)
    reference = _averaged(fine, _REFERENCE)
    first, second = (
        float(np.sqrt(np.mean((picture - reference)[outline] ** 2)))
        for picture in (ours, multisampled)
    )
    return first, second


def _averaged(picture: NDArray[np.generic], times: int) -> Pictures:
    """Return `picture` with the mean of each `times` × `times` pixels."""
    side = picture.shape[0] // times
    blocks = picture.reshape(side, times, side, times, -1)
    return np.asarray(blocks.mean(axis=(1, 3), dtype=np.float64))


def _multisampled(
    drawing: FrameRenderer,
    vertices: NDArray[np.float32],
    normals: NDArray[np.float32],
    samples: int,
) -> Pictures:
    """Return the picture as OpenGL's own multisampling makes it."""
    gl = importlib.import_module("OpenGL.GL")
    side = drawing.side
    # What `render` draws into is the framebuffer's business: it gets buffers of many samples for
    # one picture, which is then resolved into one that can be read.
    drawing.draw(vertices, normals)
    target = int(gl.glGetIntegerv(gl.GL_FRAMEBUFFER_BINDING))
    many = int(gl.glGenFramebuffers(1))
    gl.glBindFramebuffer(gl.GL_FRAMEBUFFER, many)
    colours = [gl.GL_COLOR_ATTACHMENT0 + number for number in range(PLANES)]
    kinds = [gl.GL_R8] * PLANES + [gl.GL_DEPTH_COMPONENT24]
    for kind, attachment in zip(kinds, [*colours, gl.GL_DEPTH_ATTACHMENT], strict=True):
        buffer = gl.glGenRenderbuffers(1)
        gl.glBindRenderbuffer(gl.GL_RENDERBUFFER, buffer)
        gl.glRenderbufferStorageMultisample(gl.GL_RENDERBUFFER, samples, kind, side, side)
        gl.glFramebufferRenderbuffer(gl.GL_FRAMEBUFFER, attachment, gl.GL_RENDERBUFFER, buffer)
    gl.glDrawBuffers(PLANES, colours)
    gl.glEnable(gl.GL_MULTISAMPLE)
    whole = PixelBox.full(side)
    drawing.draw_into(many, whole, RGB)
    gl.glBindFramebuffer(gl.GL_READ_FRAMEBUFFER, many)
    gl.glBindFramebuffer(gl.GL_DRAW_FRAMEBUFFER, target)
    for colour in colours:
        gl.glReadBuffer(colour)
        gl.glDrawBuffers(1, [colour])
        gl.glBlitFramebuffer(
            0, 0, side, side, 0, 0, side, side, gl.GL_COLOR_BUFFER_BIT, gl.GL_NEAREST
        )  # fmt: skip
    gl.glBindFramebuffer(gl.GL_FRAMEBUFFER, target)
    planes = np.empty((PLANES, side, side), np.uint8)
    drawing.read(whole, planes)
    return np.moveaxis(planes, 0, 2).astype(np.float64)
