"""Rendering of one mesh: from vertices to pixels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from renderer.contact_shadow import ContactShadow
from renderer.framing import Camera, look_at
from renderer.look import AMBIENT_LIGHT, BACKGROUND, LIGHTS, Colour
from renderer.offscreen import GROUND, OffscreenContext
from renderer.opengl import pyrender
from renderer.picture import RGB, SUPERSAMPLING, PixelBox

Floats = NDArray[np.float32]


class FrameRenderer:
    """Draws one mesh, seen by one camera, frame after frame; use it as a context manager.

    Parameters
    ----------
    faces : ndarray, shape (F, 3)
        Triangles, counter-clockwise seen from outside.
    colours : ndarray, shape (V, 4)
        sRGB colour of each vertex in [0, 1], and how much it gleams.
    camera : Camera
        The camera.
    size : int
        Pixels along each side of the finished frame.
    background : tuple of int
        Its colour where nothing is drawn.
    """

    def __init__(
        self,
        faces: NDArray[np.integer],
        colours: Floats,
        camera: Camera,
        size: int,
        background: Colour = BACKGROUND,
    ) -> None:
        self._attributes = np.zeros((len(colours), 10), np.float32)
        self._attributes[:, 4] = 1.0
        self._attributes[:, 6:] = colours
        self._primitive = pyrender.Primitive(
            positions=self._attributes[:, :3],
            normals=self._attributes[:, 3:6],
            color_0=self._attributes[:, 6:],
            indices=faces,
            material=pyrender.MetallicRoughnessMaterial(alphaMode="OPAQUE", doubleSided=False),
        )
        self._ground = pyrender.Primitive(
            positions=np.zeros((4, 3), np.float32),
            indices=np.array([(0, 1, 2), (0, 2, 3)]),
            material=self._primitive.material,
        )
        self.scene: Any = _build_scene(self._primitive, self._ground, camera, background)
        self.side = size * SUPERSAMPLING
        self._context: OffscreenContext | None = None

    def __enter__(self) -> Self:
        self._context = OffscreenContext(self.side)
        self._context.render(self.scene, PixelBox.full(16), RGB)  # uploads what `draw` rewrites
        return self

    def __exit__(self, *_: object) -> None:
        if self._context is not None:
            self._context.close()
            self._context = None

    @property
    def context(self) -> OffscreenContext:
        """The OpenGL context; only inside the ``with`` block."""
        if self._context is None:
            raise RuntimeError("a FrameRenderer draws only inside its with block")
        return self._context

    def box_around(self, points: Sequence[Floats]) -> PixelBox:
        """Return the part of the picture that arrays of points, shape (..., 3), take up."""
        projection = self.context.projection(self.scene)
        boxes = [PixelBox.around(part, projection, self.side) for part in points]
        return PixelBox.union(boxes)

    def draw(
        self,
        vertices: Floats,
        normals: Floats,
        box: PixelBox | None = None,
        shadow: ContactShadow | None = None,
        channels: NDArray[np.float64] = RGB,
    ) -> NDArray[np.uint8]:
        """Return the frame, `SUPERSAMPLING` times the requested size on each side.

        Parameters
        ----------
        vertices, normals : ndarray, shape (V, 3)
            Positions in metres, and unit normals.
        box : PixelBox or None
            The part to return; the whole picture for None.
        shadow : ContactShadow or None
            What the body casts on the ground.
        channels : ndarray, shape (4, 4)
            One of `renderer.picture`.

        Returns
        -------
        ndarray, shape (3, height, width), uint8
            A plane for each channel, first row on top. The next call may reuse the array.
        """
        self._attributes[:, :3] = vertices
        self._attributes[:, 3:6] = normals
        self.context.replace_attributes(self._primitive, self._attributes)
        if shadow is not None:
            self.context.replace_attributes(self._ground, shadow.corners())
        return self.context.render(self.scene, box or PixelBox.full(self.side), channels, shadow)


def _build_scene(primitive: Any, ground: Any, camera: Camera, background: Colour) -> Any:
    """Return a pyrender scene of `primitive`, the ground, the lights and the camera."""
    colour = np.array([*background, 255]) / 255.0
    scene = pyrender.Scene(bg_color=colour, ambient_light=np.array(AMBIENT_LIGHT))
    scene.add(pyrender.Mesh([primitive]))
    scene.add(pyrender.Mesh([ground]), name=GROUND)
    lens = pyrender.PerspectiveCamera(
        yfov=np.radians(camera.field_of_view), aspectRatio=1.0, znear=0.1, zfar=20.0
    )
    scene.add(lens, pose=look_at(np.array(camera.eye), np.array(camera.target)))
    for number, light in enumerate(LIGHTS):
        lamp = pyrender.DirectionalLight(color=np.array(light.colour), intensity=light.intensity)
        scene.add(lamp, name=f"{number}", pose=look_at(np.array(light.comes_from), np.zeros(3)))
    return scene
