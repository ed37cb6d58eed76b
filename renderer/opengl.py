"""Offscreen OpenGL for pyrender 0.1.45; import pyrender from here.

pyrender's last release pins PyOpenGL 3.1.0 and was written for older Pythons. This module patches
both so that they run on a machine that only has Mesa's software library:

- PyOpenGL 3.1.0 does not bind ``OSMesaCreateContextAttribs``, which pyrender calls;
- it returns a new pointer object for the current OSMesa context at every call. pyrender's shader
  cache, which uses it as a key, never hits, so that each frame compiles its shader again and leaks;
- it has no array handler for the ctypes argument type under its name in Python 3.12;
- pyrender imports its window viewer, hence pyglet and X11, even if no window is needed;
- its mesh bounds use ``np.infty``, which NumPy 2 has removed.
"""

import ctypes
import ctypes.util
import importlib
import os
import sys
import types
from typing import Any, Final

import numpy as np

from motion.errors import InputError

_OSMESA_CONSTANTS: Final = {
    "OSMESA_DEPTH_BITS": 0x30,
    "OSMESA_STENCIL_BITS": 0x31,
    "OSMESA_ACCUM_BITS": 0x32,
    "OSMESA_PROFILE": 0x33,
    "OSMESA_CORE_PROFILE": 0x34,
    "OSMESA_COMPAT_PROFILE": 0x35,
    "OSMESA_CONTEXT_MAJOR_VERSION": 0x36,
    "OSMESA_CONTEXT_MINOR_VERSION": 0x37,
}
_LIBRARIES: Final = {"osmesa": "OSMesa", "egl": "EGL"}


def _choose_platform() -> str:
    """Return the offscreen platform to use: OSMesa if available, otherwise EGL."""
    requested = os.environ.get("PYOPENGL_PLATFORM")
    for platform, library in _LIBRARIES.items():
        if requested in (None, platform) and ctypes.util.find_library(library):
            return platform
    raise InputError(
        f"no offscreen OpenGL library was found (looked for {requested or 'OSMesa, then EGL'})",
        remedy="Install Mesa's software renderer: sudo apt-get install libosmesa6"
        " (where that package is gone: libegl1 and libgl1-mesa-dri)",
    )


def _patch_osmesa() -> None:
    """Add the OSMesa functions that pyrender needs to PyOpenGL 3.1.0."""
    platform = importlib.import_module("OpenGL.platform")
    osmesa = importlib.import_module("OpenGL.osmesa")
    # Plain addresses are equal and hashable; PyOpenGL's pointer objects are not.
    platform.PLATFORM.GetCurrentContext.restype = ctypes.c_void_p
    create = platform.PLATFORM.OSMesa.OSMesaCreateContextAttribs
    create.restype = osmesa.OSMesaContext
    create.argtypes = [ctypes.c_void_p, ctypes.c_void_p]

    def create_context(attributes: Any, shared: Any) -> Any:
        """Call the library's own function, which PyOpenGL does not bind."""
        return create(ctypes.addressof(attributes), shared)

    for name, value in {"OSMesaCreateContextAttribs": create_context, **_OSMESA_CONSTANTS}.items():
        setattr(osmesa, name, value)


def _patch_python_312() -> None:
    """Register the handler of ctypes' argument type under its new module name."""
    formats = importlib.import_module("OpenGL.plugins").FormatHandler
    formats(
        "ctypesparameter312",
        "OpenGL.arrays.ctypesparameters.CtypesParameterHandler",
        ["_ctypes.CArgObject"],
    )


def _import_pyrender() -> Any:
    """Import pyrender without its window viewer."""
    viewer = types.ModuleType("pyrender.viewer")
    viewer.Viewer = type("Viewer", (), {})  # type: ignore[attr-defined]
    sys.modules.setdefault("pyrender.viewer", viewer)
    module = importlib.import_module("pyrender")

    def bounds(mesh: Any) -> Any:
        """Return the bounding box of all primitives, shape (2, 3)."""
        boxes = np.array([primitive.bounds for primitive in mesh.primitives])
        return np.stack([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])

    module.Mesh.bounds = property(bounds)
    return module


PLATFORM: Final = _choose_platform()
"""``osmesa`` or ``egl``."""

os.environ["PYOPENGL_PLATFORM"] = PLATFORM
_patch_python_312()
if PLATFORM == "osmesa":
    _patch_osmesa()
pyrender: Final = _import_pyrender()
"""The patched pyrender package."""
