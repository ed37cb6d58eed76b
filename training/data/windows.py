"""Windows of takes: the same stretch of time of all features of a take."""

from collections.abc import Mapping

import numpy as np

from motion.arrays import Floats32, Ints
from motion.errors import InputError
from training.data.feature_cache import PreparedTakes
from training.data.take import Split, Take


class Windows:
    """Windows of equal length, cut from the takes of one split.

    Window k of a take covers its frames ``k * stride`` to ``k * stride + frames - 1``, in every
    feature alike.

    Parameters
    ----------
    prepared : PreparedTakes
        The takes and their features.
    split : {'train', 'validation', 'test'}
        The split of the takes.
    frames : int
        Frames of a window, at least 1.
    stride : int
        Frames from one window of a take to the next, at least 1.

    Raises
    ------
    InputError
        If no take of the split is as long as a window.
    """

    def __init__(self, prepared: PreparedTakes, *, split: Split, frames: int, stride: int) -> None:
        self.frames = frames
        self.stride = stride
        self.frame_rate = prepared.frame_rate
        self.prepared = prepared
        indices = [index for index, take in enumerate(prepared.takes) if take.split == split]
        self._takes = [index for index in indices if prepared.frames(index) >= frames]
        counts = [(prepared.frames(index) - frames) // stride + 1 for index in self._takes]
        self._first_row = np.concatenate([[0], np.cumsum(counts, dtype=np.int64)])
        if not self._takes:
            raise InputError(
                f"none of {len(indices)} takes for {split} lasts the "
                f"{frames / prepared.frame_rate:.3g} s of a window",
                remedy="Give longer takes, or another split list",
            )

    def __len__(self) -> int:
        """Return the number of windows."""
        return int(self._first_row[-1])

    def batch(self, rows: Ints) -> Mapping[str, Floats32]:
        """Return the windows of `rows` for each feature, (len(rows), frames, channels)."""
        positions = [self._locate(int(row)) for row in rows]
        return {
            name: np.stack([arrays[take][start : start + self.frames] for take, start in positions])
            for name, arrays in self.prepared.arrays.items()
        }

    def take_of(self, row: int) -> Take:
        """Return the take of window `row`."""
        return self.prepared.takes[self._locate(row)[0]]

    def takes(self, rows: Ints) -> list[Take]:
        """Return the takes of the windows of `rows`."""
        return [self.take_of(int(row)) for row in rows]

    def speakers(self, rows: Ints) -> list[str]:
        """Return the speakers of the windows of `rows`."""
        return [take.speaker for take in self.takes(rows)]

    def _locate(self, row: int) -> tuple[int, int]:
        """Return the index of the take of window `row`, and the window's first frame."""
        place = int(np.searchsorted(self._first_row, row, side="right")) - 1
        return self._takes[place], (row - int(self._first_row[place])) * self.stride
