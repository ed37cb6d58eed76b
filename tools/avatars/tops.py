"""What is worn above the trousers, by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from tools.avatars.jackets import jacket
from tools.avatars.knitwear import sweater, t_shirt
from tools.avatars.necklines import Neckline
from tools.avatars.patch import Patch
from tools.avatars.pieces import Piece
from tools.avatars.shirts import shirt, sweater_over_shirt
from tools.avatars.sitter import Sitter


@dataclass(frozen=True, kw_only=True)
class Top:
    """A garment, or several worn together.

    Attributes
    ----------
    neckline : Neckline
        Above which the skin is bare.
    sleeve : float
        Where sleeves end: 0 at the shoulder, 1 at the elbow, 2 at the wrist.
    make : callable
        Makes its pieces from the person, the fabric, the neckline and the height of its hem.
    """

    neckline: Neckline
    sleeve: float
    make: Callable[[Sitter, Patch, Neckline, float], list[Piece]]


TOPS: Final[Mapping[str, Top]] = MappingProxyType({
    "sweater": Top(neckline=Neckline(), sleeve=1.98, make=sweater),
    "shirt": Top(
        neckline=Neckline(rise=-0.006, opening=0.07, width=0.03), sleeve=1.98, make=shirt
    ),
    "sweater_over_shirt": Top(
        neckline=Neckline(rise=-0.006, opening=0.055, width=0.02),
        sleeve=1.98,
        make=sweater_over_shirt,
    ),
    "jacket": Top(neckline=Neckline(rise=-0.03), sleeve=1.97, make=jacket),
    "t_shirt": Top(neckline=Neckline(rise=-0.01), sleeve=0.6, make=t_shirt),
})  # fmt: skip
