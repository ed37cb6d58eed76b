"""How many threads a rendering process uses."""

from __future__ import annotations

from typing import Final

ONE_THREAD: Final = {
    "LP_NUM_THREADS": "0",  # llvmpipe draws in the calling thread
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
}
"""Environment of a rendering process, read by the libraries when they load.

One thread for drawing and one for encoding in one process per core is faster than one process with
many threads.
"""
