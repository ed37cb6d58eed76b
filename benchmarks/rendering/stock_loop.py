"""A pair of clips drawn with pyrender as research code uses it, in its own process.

``python -m benchmarks.rendering.stock_loop FILE [--patched]`` draws both sides, each frame with a
new mesh in a new scene and pyrender's own renderer, collects all pictures, then encodes them side
by side. ``--patched`` repairs pyrender's shader cache; other fixes, without which it does not start
here, are always in place. Skinning is not counted. Prints one line of JSON.
"""

import ctypes
import importlib
import json
import sys
import time
from pathlib import Path
from typing import Any

import av
import numpy as np
from numpy.typing import NDArray

from motion.audio import Audio
from renderer.encoder import SOUND_RATE, VideoWriter
from renderer.opengl import PLATFORM, pyrender


def main() -> None:
    """Measure, and print ``frames``, ``seconds``, ``busy`` (processor) and ``peak_mb``."""
    file = Path(sys.argv[1])
    if "--patched" not in sys.argv:
        _undo_shader_cache_patch()
    with np.load(file) as arrays:
        vertices, faces, colours = arrays["vertices"], arrays["faces"], arrays["colours"]
        pose, angle = arrays["camera"], float(arrays["field_of_view"])
        size, rate = int(arrays["size"]), float(arrays["frame_rate"])
    wall, busy = time.perf_counter(), time.process_time()
    pictures = [_drawn(vertices, faces, colours, pose, angle, size) for _ in range(2)]
    _encode(pictures, size, rate, file.with_suffix(".mp4"))
    result = {
        "frames": len(vertices),
        "seconds": time.perf_counter() - wall,
        "busy": time.process_time() - busy,
        "peak_mb": _peak_mb(),
    }
    print(json.dumps(result))


def _peak_mb() -> float:
    """Return this process' peak memory; `resource` would include the parent's."""
    status = Path("/proc/self/status").read_text()
    return int(status.split("VmHWM:")[1].split()[0]) / 1024


class _FreshPointer(ctypes.c_void_p):
    """A pointer that equals no other, as later releases of PyOpenGL give for a context.

    The pinned release's pointer cannot be a key, which pyrender needs.
    """

    __hash__ = object.__hash__


def _undo_shader_cache_patch() -> None:
    """Return a new object for the current context at every call, so that no cache ever hits."""
    if PLATFORM == "osmesa":
        platform = importlib.import_module("OpenGL.platform")
        platform.PLATFORM.GetCurrentContext.restype = _FreshPointer


def _drawn(
    vertices: NDArray[np.float32],
    faces: NDArray[np.int64],
    colours: NDArray[np.uint8],
    camera_pose: NDArray[np.float64],
    angle: float,
    size: int,
) -> list[NDArray[np.uint8]]:
    """Return all pictures of one side, RGB."""
    trimesh = importlib.import_module("trimesh")
    renderer = pyrender.OffscreenRenderer(size, size)
    pictures = []
    for positions in vertices:
        scene = pyrender.Scene(bg_color=(0.93, 0.93, 0.93, 1.0), ambient_light=(0.4, 0.4, 0.4))
        mesh: Any = trimesh.Trimesh(positions, faces, vertex_colors=colours, process=False)
        scene.add(pyrender.Mesh.from_trimesh(mesh, smooth=True))
        scene.add(pyrender.PerspectiveCamera(yfov=np.radians(angle)), pose=camera_pose)
        scene.add(pyrender.DirectionalLight(intensity=2.5), pose=camera_pose)
        colour, _ = renderer.render(scene)
        pictures.append(colour)
    renderer.delete()
    return pictures


def _encode(sides: list[list[NDArray[np.uint8]]], size: int, frame_rate: float, path: Path) -> None:
    silence = Audio(
        np.zeros(round(len(sides[0]) / frame_rate * SOUND_RATE), np.float32), SOUND_RATE
    )
    with VideoWriter(path, 2 * size, size, frame_rate, silence) as writer:
        for left, right in zip(*sides, strict=True):
            picture = np.concatenate([left, right], axis=1)
            frame = av.VideoFrame.from_ndarray(picture, format="rgb24")
            writer.write(frame.reformat(format="yuv420p"))


if __name__ == "__main__":
    main()
