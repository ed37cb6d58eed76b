"""A pair of clips through Blender's Workbench engine, inside Blender itself.

``blender --background --python blender_loop.py -- FILE`` draws both sides of what
`stock_loop.py` draws, frame by frame, antialiased by FXAA, and leaves each picture in
Blender's memory: nothing is encoded or saved. Prints one line of JSON.
"""

from __future__ import annotations

import json
import math
import sys
import time
from pathlib import Path

import bpy  # type: ignore[import-not-found]
import numpy as np


def main() -> None:
    """Measure, and print ``frames``, ``seconds``, ``busy`` (processor) and ``peak_mb``."""
    with np.load(sys.argv[sys.argv.index("--") + 1]) as arrays:
        vertices, faces, colours = arrays["vertices"], arrays["faces"], arrays["colours"]
        pose, angle, size = arrays["camera"], float(arrays["field_of_view"]), int(arrays["size"])
    mesh = _build_scene(vertices[0], faces, colours, pose, angle, size)
    _draw(mesh, vertices[0])  # what is compiled and loaded at first is not counted
    wall, busy = time.perf_counter(), time.process_time()
    for _ in range(2):
        for positions in vertices:
            _draw(mesh, positions)
    result = {
        "frames": len(vertices),
        "seconds": time.perf_counter() - wall,
        "busy": time.process_time() - busy,
        "peak_mb": _peak_mb(),
    }
    print(json.dumps(result), flush=True)


def _build_scene(
    positions: np.ndarray,
    faces: np.ndarray,
    colours: np.ndarray,
    camera_pose: np.ndarray,
    angle: float,
    size: int,
) -> bpy.types.Mesh:
    """Leave nothing in the scene but the mesh and the camera, and return the mesh."""
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    mesh = bpy.data.meshes.new("body")
    mesh.from_pydata(positions.tolist(), [], faces.tolist())
    mesh.polygons.foreach_set("use_smooth", [True] * len(faces))
    colour = mesh.color_attributes.new("colour", "BYTE_COLOR", "POINT")
    shades = np.concatenate([colours / 255, np.ones((len(colours), 1))], axis=1)
    colour.data.foreach_set("color", shades.astype(np.float32).ravel())
    scene = bpy.context.scene
    scene.collection.objects.link(bpy.data.objects.new("body", mesh))
    lens = bpy.data.cameras.new("camera")
    lens.angle = math.radians(angle)
    camera = bpy.data.objects.new("camera", lens)
    camera.matrix_world = camera_pose.T.tolist()
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.engine = "BLENDER_WORKBENCH"
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.display.render_aa = "FXAA"
    scene.display.shading.color_type = "VERTEX"
    return mesh


def _draw(mesh: bpy.types.Mesh, positions: np.ndarray) -> None:
    """Draw one frame."""
    mesh.vertices.foreach_set("co", positions.ravel())
    mesh.update()
    bpy.ops.render.render()


def _peak_mb() -> float:
    """Return this process's largest memory."""
    return int(Path("/proc/self/status").read_text().split("VmHWM:")[1].split()[0]) / 1024


if __name__ == "__main__":
    main()
