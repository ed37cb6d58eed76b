"""Rendering one mesh, from vertices to pixels.

An offscreen OpenGL context draws a part of a square picture and reads it back once.
"""

import ctypes
import importlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from motion.arrays import Floats, Floats32
from motion.errors import InputError
from renderer.contact_shadow import ELLIPSES, ContactShadow
from renderer.framing import Camera, look_at
from renderer.look import AMBIENT_LIGHT, BACKGROUND, LIGHTS, Colour
from renderer.opengl import PLATFORM, pyrender
from renderer.picture import RGB, SUPERSAMPLING, PixelBox

_SHADERS: Final = Path(__file__).parent / "shaders"
_PLATFORM_CLASSES: Final = {"osmesa": "OSMesaPlatform", "egl": "EGLPlatform"}
GROUND: Final = "ground"
"""Name of the scene's node whose mesh, of four corners, shows the shadow."""

PLANES: Final = 3
"""Number of buffers of one channel each into which a picture is drawn."""

_PLATFORM_BUFFER_SIZE: Final = 16  # of the context's own buffer, which is not used


class _DirectRenderer(pyrender.Renderer):  # type: ignore[misc]
    """pyrender's renderer with our shaders, drawing opaque meshes into a persistent framebuffer.

    pyrender's own forward pass multisamples, blends, sets camera and lights again for each frame,
    and flushes, which makes OSMesa copy the whole picture again.
    """

    def __init__(self, size: int) -> None:
        super().__init__(size, size)
        self._gl = importlib.import_module("OpenGL.GL")
        cache = importlib.import_module("pyrender.shader_program").ShaderProgramCache
        self._program_cache = cache(str(_SHADERS))
        self.box = PixelBox.full(size)
        self.channels: Floats = RGB
        self.shadow: ContactShadow | None = None

    def _forward_pass(self, scene: Any, flags: int, seg_node_map: Any = None) -> None:
        """Draw the meshes of `scene` upside down, so that the first row read back is the top."""
        gl = self._gl
        # Shifts the picture so that the framebuffer holds the box.
        gl.glViewport(-self.box.left, -self.box.top, self.viewport_width, self.viewport_height)
        gl.glEnable(gl.GL_DEPTH_TEST)
        gl.glEnable(gl.GL_CULL_FACE)
        gl.glFrontFace(gl.GL_CW)  # flipping the picture reverses triangles
        background = self.channels @ [*scene.bg_color[:3], 1.0]
        for plane in range(PLANES):
            gl.glClearBufferfv(gl.GL_COLOR, plane, np.full(4, background[plane], np.float32))
        gl.glClear(gl.GL_DEPTH_BUFFER_BIT)
        grounds = [node for node in scene.mesh_nodes if node.name == GROUND]
        meshes = [node for node in scene.mesh_nodes if node.name != GROUND]
        if self.shadow is not None:
            # The body always covers the ground, even if a foot sinks in.
            gl.glDepthMask(gl.GL_FALSE)
            self._draw(grounds, self._shadow_program(scene, self.shadow))
            gl.glDepthMask(gl.GL_TRUE)
        self._draw(meshes, self._lit_program(scene))

    def _draw(self, nodes: list[Any], program: Any) -> None:
        program._bind()
        for node in nodes:
            for primitive in node.mesh.primitives:
                primitive._bind()
                self._gl.glDrawElements(
                    primitive.mode,
                    primitive.indices.size,
                    self._gl.GL_UNSIGNED_INT,
                    ctypes.c_void_p(0),
                )

    def _lit_program(self, scene: Any) -> Any:
        """Return the program for the body, with camera and lights set."""
        program, new = self._program("lit", MAX_LIGHTS=len(scene.directional_light_nodes))
        if new:
            self._set_camera_and_lights(program, scene)
        program.set_uniform("channels", self.channels)
        return program

    def _shadow_program(self, scene: Any, shadow: ContactShadow) -> Any:
        """Return the program for the ground, with camera and shadow set."""
        program, new = self._program("shadow", ELLIPSES=ELLIPSES)
        if new:
            program.set_uniform("projection", self.projection(scene))
            program.set_uniform("background", np.array(scene.bg_color[:3]))
        program.set_uniform("channels", self.channels)
        for number in range(ELLIPSES):
            program.set_uniform(f"centres[{number}]", shadow.centres[number])
            program.set_uniform(f"into_circle[{number}]", np.linalg.inv(shadow.axes[number]))
            program.set_uniform(f"darkness[{number}]", float(shadow.darkness[number]))
        return program

    def _program(self, name: str, **defines: int) -> tuple[Any, bool]:
        """Bind and return a shader program, and whether it was just compiled."""
        program = self._program_cache.get_program(f"{name}.vert", f"{name}.frag", defines=defines)
        new = not program._in_context()
        if new:
            program._add_to_context()
        program._bind()
        return program, new

    def projection(self, scene: Any) -> Floats:
        """Return the matrix from positions to clip space, y down, shape (4, 4)."""
        view, lens = self._get_camera_matrices(scene)
        return np.asarray(np.diag([1.0, -1.0, 1.0, 1.0]) @ lens @ view)

    def _set_camera_and_lights(self, program: Any, scene: Any) -> None:
        """Set camera and lights, which are the same for all frames.

        The lights are ordered by name: pyrender takes them from a set, whose order, and therefore
        the rounding of their sum, differs from run to run.
        """
        program.set_uniform("projection", self.projection(scene))
        program.set_uniform("cam_pos", scene.get_pose(scene.main_camera_node)[:3, 3])
        nodes = sorted(scene.directional_light_nodes, key=lambda light: str(light.name))
        program.set_uniform("ambient_light", scene.ambient_light)
        program.set_uniform("n_directional_lights", len(nodes))
        for number, light in enumerate(nodes):
            uniform = f"directional_lights[{number}]."
            program.set_uniform(f"{uniform}direction", -scene.get_pose(light)[:3, 2])
            program.set_uniform(f"{uniform}color", light.light.color)
            program.set_uniform(f"{uniform}intensity", light.light.intensity)


class FrameRenderer:
    """Draws one mesh, seen by one camera, frame after frame; use it as a context manager.

    Parameters
    ----------
    faces : ndarray, shape (F, 3)
        Triangles, counter-clockwise seen from outside.
    colours : ndarray, shape (V, 4)
        sRGB colour of each vertex in [0, 1], and its gloss.
    camera : Camera
        The camera.
    size : int
        Pixels along each side of the finished frame.
    background : tuple of int
        The frame's background colour.
    """

    def __init__(
        self,
        faces: NDArray[np.integer],
        colours: Floats32,
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

    def __enter__(self) -> Self:
        self._gl = importlib.import_module("OpenGL.GL")
        platforms = importlib.import_module(f"pyrender.platforms.{PLATFORM}")
        # Kept for as long as the context: OSMesa refers to the platform object's own buffer.
        self._platform: Any = getattr(platforms, _PLATFORM_CLASSES[PLATFORM])(
            _PLATFORM_BUFFER_SIZE, _PLATFORM_BUFFER_SIZE
        )
        try:
            self._platform.init_context()
            self._platform.make_current()
        except (AssertionError, OSError, RuntimeError) as error:
            raise InputError(
                f"OpenGL could not be started through {PLATFORM}: {error}",
                remedy="Install Mesa's software renderer: sudo apt-get install libosmesa6",
            ) from error
        self._renderer = _DirectRenderer(self.side)
        self._framebuffer = int(self._gl.glGenFramebuffers(1))
        self._buffers = [int(self._gl.glGenRenderbuffers(1)) for _ in range(PLANES + 1)]
        self._pixels = np.empty((PLANES, 0, 0), np.uint8)
        self._render(PixelBox.full(16), RGB)  # uploads what `draw` rewrites
        return self

    def __exit__(self, *_: object) -> None:
        self._platform.make_current()
        self._renderer.delete()
        self._gl.glDeleteRenderbuffers(len(self._buffers), self._buffers)
        self._gl.glDeleteFramebuffers(1, [self._framebuffer])
        self._platform.delete_context()

    def box_around(self, points: Sequence[Floats32]) -> PixelBox:
        """Return the part of the picture that contains arrays of points, shape (..., 3)."""
        projection = self._renderer.projection(self.scene)
        boxes = [PixelBox.around(part, projection, self.side) for part in points]
        return PixelBox.union(boxes)

    def draw(
        self,
        vertices: Floats32,
        normals: Floats32,
        box: PixelBox | None = None,
        shadow: ContactShadow | None = None,
        channels: Floats = RGB,
    ) -> NDArray[np.uint8]:
        """Return the frame, `SUPERSAMPLING` times the requested size on each side.

        Parameters
        ----------
        vertices, normals : ndarray, shape (V, 3)
            Positions in metres, and unit normals.
        box : PixelBox or None
            The part to return; the whole picture for None.
        shadow : ContactShadow or None
            The body's shadow on the ground.
        channels : ndarray, shape (4, 4)
            `renderer.picture.RGB` or `VIDEO`.

        Returns
        -------
        ndarray, shape (3, height, width), uint8
            A plane for each channel, first row on top. The next call may reuse the array.
        """
        self._attributes[:, :3] = vertices
        self._attributes[:, 3:6] = normals
        self._replace_attributes(self._primitive, self._attributes)
        if shadow is not None:
            self._replace_attributes(self._ground, shadow.corners())
        return self._render(box or PixelBox.full(self.side), channels, shadow)

    def _render(
        self, box: PixelBox, channels: Floats, shadow: ContactShadow | None = None
    ) -> NDArray[np.uint8]:
        """Return the part of the picture in `box`, shape (3, height, width)."""
        gl, renderer = self._gl, self._renderer
        self._platform.make_current()
        if self._pixels.shape[1:] != (box.height, box.width):
            self._resize(box)
        gl.glBindFramebuffer(gl.GL_FRAMEBUFFER, self._framebuffer)
        renderer.box, renderer.channels, renderer.shadow = box, channels, shadow
        renderer.render(self.scene, pyrender.RenderFlags.NONE)
        gl.glPixelStorei(gl.GL_PACK_ALIGNMENT, 1)
        for number, plane in enumerate(self._pixels):
            gl.glReadBuffer(gl.GL_COLOR_ATTACHMENT0 + number)
            gl.glReadPixels(
                0, 0, box.width, box.height, gl.GL_RED, gl.GL_UNSIGNED_BYTE, array=plane
            )
        return self._pixels

    def _replace_attributes(self, primitive: Any, attributes: Floats32) -> None:
        """Overwrite the interleaved vertex attributes of a `primitive` that was already drawn."""
        gl = self._gl
        gl.glBindBuffer(gl.GL_ARRAY_BUFFER, primitive._buffers[0])
        data = attributes.ctypes.data_as(ctypes.c_void_p)
        gl.glBufferSubData(gl.GL_ARRAY_BUFFER, 0, attributes.nbytes, data)

    def _resize(self, box: PixelBox) -> None:
        """Give the framebuffer the size of `box`."""
        gl = self._gl
        self._pixels = np.empty((PLANES, box.height, box.width), np.uint8)
        gl.glBindFramebuffer(gl.GL_FRAMEBUFFER, self._framebuffer)
        colours = [gl.GL_COLOR_ATTACHMENT0 + number for number in range(PLANES)]
        # Float depth is faster here than 24 bits, which share their word with a stencil.
        formats = [gl.GL_R8] * PLANES + [gl.GL_DEPTH_COMPONENT32F]
        for buffer, buffer_format, attachment in zip(
            self._buffers, formats, [*colours, gl.GL_DEPTH_ATTACHMENT], strict=True
        ):
            gl.glBindRenderbuffer(gl.GL_RENDERBUFFER, buffer)
            gl.glRenderbufferStorage(gl.GL_RENDERBUFFER, buffer_format, box.width, box.height)
            gl.glFramebufferRenderbuffer(gl.GL_FRAMEBUFFER, attachment, gl.GL_RENDERBUFFER, buffer)
        gl.glDrawBuffers(PLANES, colours)


def _build_scene(primitive: Any, ground: Any, camera: Camera, background: Colour) -> Any:
    """Return a pyrender scene of `primitive`, the ground, the lights and the camera."""
    colour = np.array([*background, 255]) / 255.0
    scene = pyrender.Scene(bg_color=colour, ambient_light=np.array(AMBIENT_LIGHT))
    scene.add(pyrender.Mesh([primitive]))
    scene.add(pyrender.Mesh([ground]), name=GROUND)
    eye, target = np.array(camera.eye), np.array(camera.target)
    lens = pyrender.PerspectiveCamera(
        yfov=np.radians(camera.field_of_view),
        aspectRatio=1.0,
        znear=0.1,
        zfar=max(20.0, 2 * float(np.linalg.norm(eye - target))),
    )
    scene.add(lens, pose=look_at(eye, target))
    for number, light in enumerate(LIGHTS):
        lamp = pyrender.DirectionalLight(color=np.array(light.colour), intensity=light.intensity)
        scene.add(lamp, name=f"{number}", pose=look_at(np.array(light.comes_from), np.zeros(3)))
    return scene
