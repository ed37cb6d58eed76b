"""All pieces of one avatar: its skin, face, hair and clothes."""

from __future__ import annotations

from typing import Final

from renderer.avatar.beard import beard
from renderer.avatar.bob import bob
from renderer.avatar.brows import brows
from renderer.avatar.bun import bun
from renderer.avatar.cloth import fabric
from renderer.avatar.eyes import eyeballs, lashes
from renderer.avatar.glasses import glasses
from renderer.avatar.hair import CUTS, hair_on_scalp
from renderer.avatar.hands import arms
from renderer.avatar.head import head
from renderer.avatar.mannequin import mannequin
from renderer.avatar.pieces import Piece
from renderer.avatar.sitter import Sitter
from renderer.avatar.tops import TOPS
from renderer.avatar.trousers import shoes, trousers
from renderer.avatars import Avatar

_HEM_ABOVE_HIPS: Final = 0.015
_BOB_LENGTH: Final = 0.125


def pieces_of(avatar: Avatar, sitter: Sitter) -> list[Piece]:
    """Return all that can be seen of `avatar`."""
    top = TOPS[avatar.top]
    hem = float(sitter.joint("left_hip")[1]) + _HEM_ABOVE_HIPS
    cloth = fabric(sitter)
    if not avatar.has_face:
        return mannequin(sitter, cloth)
    return [
        *head(sitter, top.neckline),
        *eyeballs(sitter),
        *lashes(sitter),
        brows(sitter, avatar.brow_thickness),
        *_hair(avatar, sitter),
        *arms(sitter, top.sleeve),
        *top.make(sitter, cloth, top.neckline, hem),
        trousers(sitter, cloth, hem),
        *shoes(sitter, cloth),
    ]


def _hair(avatar: Avatar, sitter: Sitter) -> list[Piece]:
    """Return hair, beard and glasses."""
    pieces = []
    if avatar.hair == "bob":
        pieces.append(bob(sitter, _BOB_LENGTH))
    elif avatar.hair:
        pieces.append(hair_on_scalp(sitter, CUTS[avatar.hair]))
    if avatar.hair == "bun":
        pieces.append(bun(sitter))
    if avatar.beard:
        pieces.append(beard(sitter))
    if avatar.glasses:
        pieces.append(glasses(sitter))
    return pieces
