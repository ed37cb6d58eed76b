"""One progress bar for all long work."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from tqdm import tqdm


@contextmanager
def progress(title: str, unit: str) -> Iterator[Callable[[int, int], None]]:
    """Show a bar with rate and time left; yield a function of (done, total).

    Parameters
    ----------
    title : str
        What is being done.
    unit : str
        What is counted, in the singular.
    """
    # A bar that an error stopped is wiped away: the error says what happened.
    with tqdm(desc=title, unit=f" {unit}", dynamic_ncols=True, mininterval=0.5, leave=False) as bar:

        def show(done: int, total: int) -> None:
            bar.total = total
            bar.update(done - bar.n)

        yield show
        bar.leave = True
