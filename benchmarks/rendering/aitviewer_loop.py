"""A pair of clips through aitviewer, in a Python environment that has it.

``python aitviewer_loop.py FILE`` draws both sides of what `stock_loop.py` draws with
aitviewer's headless renderer, 4 × multisampled as it comes, without its floor and its shadows, and
keeps each picture in memory: nothing is encoded or saved. Prints one line of JSON.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

import numpy as np
from aitviewer.configuration import CONFIG  # type: ignore[import-not-found]
from aitviewer.headless import HeadlessRenderer  # type: ignore[import-not-found]
from aitviewer.renderables.meshes import Meshes  # type: ignore[import-not-found]
from aitviewer.scene.camera import PinholeCamera  # type: ignore[import-not-found]


def main() -> None:
    """Measure, and print ``frames``, ``seconds``, ``busy`` (processor) and ``peak_mb``."""
    with np.load(sys.argv[1]) as arrays:
        vertices, faces, colours = arrays["vertices"], arrays["faces"], arrays["colours"]
        pose, angle, size = arrays["camera"], float(arrays["field_of_view"]), int(arrays["size"])
    CONFIG.update_conf({"window_width": size, "window_height": size})
    viewer = HeadlessRenderer()
    viewer.scene.floor.enabled = False
    viewer.scene.origin.enabled = False
    viewer.shadows_enabled = False
    shades = np.concatenate([colours / 255, np.ones((len(colours), 1))], axis=1)
    viewer.scene.add(Meshes(vertices, faces, vertex_colors=shades))
    eye = pose[:3, 3]
    camera = PinholeCamera(eye, eye - pose[:3, 2], size, size, fov=angle, viewer=viewer)
    viewer.scene.add(camera)
    viewer.set_temp_camera(camera)
    viewer.get_frame()  # what is compiled and loaded at first is not counted
    wall, busy = time.perf_counter(), time.process_time()
    for _ in range(2):
        for frame in range(len(vertices)):
            viewer.scene.current_frame_id = frame
            viewer.get_frame()
    result = {
        "frames": len(vertices),
        "seconds": time.perf_counter() - wall,
        "busy": time.process_time() - busy,
        "peak_mb": _peak_mb(),
    }
    print(json.dumps(result))


def _peak_mb() -> float:
    """Return this process's largest memory."""
    return int(Path("/proc/self/status").read_text().split("VmHWM:")[1].split()[0]) / 1024


if __name__ == "__main__":
    main()
