"""One offscreen OpenGL context with a square colour buffer that is read without detours."""

from __future__ import annotations

import ctypes
import importlib
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError
from renderer.opengl import PLATFORM, pyrender

_SHADERS: Final = Path(__file__).parent / "shaders"
_OSMESA_Y_UP: Final = 0x11
_PLATFORM_CLASSES: Final = {"osmesa": "OSMesaPlatform", "egl": "EGLPlatform"}


class _DirectRenderer(pyrender.Renderer):  # type: ignore[misc]
    """pyrender's renderer with our shaders, drawing into whatever framebuffer is bound."""

    def __init__(self, side: int) -> None:
        super().__init__(side, side)
        cache = importlib.import_module("pyrender.shader_program").ShaderProgramCache
        self._program_cache = cache(str(_SHADERS))
        self.framebuffer = 0

    def _configure_forward_pass_viewport(self, flags: int) -> None:
        """Bind the kept framebuffer; pyrender would multisample, or copy, or both."""
        gl = importlib.import_module("OpenGL.GL")
        gl.glBindFramebuffer(gl.GL_FRAMEBUFFER, self.framebuffer)
        gl.glViewport(0, 0, self.viewport_width, self.viewport_height)
        gl.glEnable(gl.GL_DEPTH_TEST)
        gl.glDepthMask(gl.GL_TRUE)
        gl.glDepthFunc(gl.GL_LESS)

    def _bind_lighting(self, scene: Any, program: Any, node: Any, flags: int) -> None:
        """Hand the lights over in the order of their names.

        pyrender takes them from a set, whose order, and with it the rounding of their sum,
        differs from run to run.
        """
        nodes = sorted(scene.directional_light_nodes, key=lambda light: str(light.name))
        program.set_uniform("ambient_light", scene.ambient_light)
        program.set_uniform("n_directional_lights", len(nodes))
        for number, light in enumerate(nodes):
            uniform = f"directional_lights[{number}]."
            program.set_uniform(f"{uniform}direction", -scene.get_pose(light)[:3, 2])
            program.set_uniform(f"{uniform}color", light.light.color)
            program.set_uniform(f"{uniform}intensity", light.light.intensity)


class OffscreenContext:
    """A current OpenGL context of `side` × `side` pixels; call `close` when done with it."""

    def __init__(self, side: int) -> None:
        self.side = side
        self._gl = importlib.import_module("OpenGL.GL")
        platforms = importlib.import_module(f"pyrender.platforms.{PLATFORM}")
        # Kept for as long as the context: OSMesa draws into the platform object's own buffer.
        self._platform: Any = getattr(platforms, _PLATFORM_CLASSES[PLATFORM])(side, side)
        try:
            self._platform.init_context()
            self._platform.make_current()
        except (AssertionError, OSError, RuntimeError) as error:
            raise InputError(
                f"OpenGL could not be started through {PLATFORM}: {error}",
                remedy="Install Mesa's software renderer: sudo apt-get install libosmesa6",
            ) from error
        self._renderer = _DirectRenderer(side)
        if PLATFORM == "osmesa":
            importlib.import_module("OpenGL.osmesa").OSMesaPixelStore(_OSMESA_Y_UP, 0)
            self._pixels = np.asarray(self._platform._buffer)
        else:
            self._renderer.framebuffer = self._make_framebuffer()
            self._pixels = np.zeros((side, side, 4), np.uint8)

    def render(self, scene: Any) -> NDArray[np.uint8]:
        """Return `scene` as RGBA, first row on top; the next call may reuse the array."""
        self._platform.make_current()
        self._renderer.render(scene, pyrender.RenderFlags.NONE)
        self._gl.glFinish()
        if PLATFORM == "osmesa":
            return self._pixels
        gl = self._gl
        gl.glReadPixels(
            0, 0, self.side, self.side, gl.GL_RGBA, gl.GL_UNSIGNED_BYTE, array=self._pixels
        )
        return np.ascontiguousarray(self._pixels[::-1])

    def replace_attributes(self, primitive: Any, attributes: NDArray[np.float32]) -> None:
        """Write the interleaved vertex attributes of a `primitive` that was already drawn."""
        gl = self._gl
        gl.glBindBuffer(gl.GL_ARRAY_BUFFER, primitive._buffers[0])
        data = attributes.ctypes.data_as(ctypes.c_void_p)
        gl.glBufferSubData(gl.GL_ARRAY_BUFFER, 0, attributes.nbytes, data)

    def compiled_shaders(self) -> int:
        """Return how many shader programs this context has compiled so far."""
        return len(self._renderer._program_cache._program_cache)

    def close(self) -> None:
        """Free what OpenGL holds."""
        self._platform.make_current()
        self._renderer.delete()
        self._platform.delete_context()

    def _make_framebuffer(self) -> int:
        """Return a framebuffer with a colour and a depth buffer of the context's size."""
        gl = self._gl
        framebuffer = int(gl.glGenFramebuffers(1))
        gl.glBindFramebuffer(gl.GL_FRAMEBUFFER, framebuffer)
        for kind, attachment in (
            (gl.GL_RGBA8, gl.GL_COLOR_ATTACHMENT0),
            (gl.GL_DEPTH_COMPONENT24, gl.GL_DEPTH_ATTACHMENT),
        ):
            buffer = gl.glGenRenderbuffers(1)
            gl.glBindRenderbuffer(gl.GL_RENDERBUFFER, buffer)
            gl.glRenderbufferStorage(gl.GL_RENDERBUFFER, kind, self.side, self.side)
            gl.glFramebufferRenderbuffer(gl.GL_FRAMEBUFFER, attachment, gl.GL_RENDERBUFFER, buffer)
        return framebuffer
