"""Plain studies of any size, for tests of planning."""

import numpy as np

from analysis.planning.part import Kind, Part, Size, Trials


def sketched(
    kind: Kind, participants: int, items: int, *, conditions: int = 2, blocks: int = 1
) -> Part:
    """Return a part in which everybody judges all items, each as often with either side first."""
    who, what = np.divmod(np.arange(participants * items), items)
    left = (who + what) % 2 if kind == "pairs" else None
    return Part(
        name="",
        kind=kind,
        trials=Trials(
            participants=who,
            items=what,
            conditions=conditions,
            left=left,
            right=None if left is None else 1 - left,
        ),
        levels=5,
        blocks=blocks,
        family="",
    )


def three_comparisons(participants: int, items: int) -> Size:
    """Return a study of three comparisons, each with its own participants; a tenth is excluded."""
    analysed = round(0.9 * participants)
    return Size(
        participants=participants,
        items=items,
        recruited=3 * participants,
        analysed=analysed,
        trials=items,
        parts=(sketched("pairs", analysed, items, blocks=3),),
    )
