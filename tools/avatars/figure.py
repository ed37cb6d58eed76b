"""All pieces of one avatar: its skin, face, hair and clothes."""

from __future__ import annotations

from typing import Final

from renderer.avatars import AVATARS
from tools.avatars.beard import beard
from tools.avatars.bob import bob
from tools.avatars.brows import brows
from tools.avatars.bun import bun
from tools.avatars.cloth import fabric
from tools.avatars.eyes import eyeballs, lashes
from tools.avatars.glasses import glasses
from tools.avatars.hair import CUTS, hair_on_scalp
from tools.avatars.hands import arms
from tools.avatars.head import head
from tools.avatars.mannequin import mannequin
from tools.avatars.pieces import Piece
from tools.avatars.recipes import Recipe
from tools.avatars.sitter import Sitter
from tools.avatars.tops import TOPS
from tools.avatars.trousers import shoes, trousers

_HEM_ABOVE_HIPS: Final = 0.015
_BOB_LENGTH: Final = 0.125


def pieces_of(recipe: Recipe, sitter: Sitter) -> list[Piece]:
    """Return all that can be seen of `recipe`."""
    top = TOPS[recipe.top]
    hem = float(sitter.joint("left_hip")[1]) + _HEM_ABOVE_HIPS
    cloth = fabric(sitter)
    if not AVATARS[recipe.name].has_face:
        return mannequin(sitter, cloth)
    return [
        *head(sitter, top.neckline),
        *eyeballs(sitter),
        *lashes(sitter),
        brows(sitter, recipe.brow_thickness),
        *_hair(recipe, sitter),
        *arms(sitter, top.sleeve),
        *top.make(sitter, cloth, top.neckline, hem),
        trousers(sitter, cloth, hem),
        *shoes(sitter, cloth),
    ]


def _hair(recipe: Recipe, sitter: Sitter) -> list[Piece]:
    """Return hair, beard and glasses."""
    pieces = []
    if recipe.hair == "bob":
        pieces.append(bob(sitter, _BOB_LENGTH))
    elif recipe.hair:
        pieces.append(hair_on_scalp(sitter, CUTS[recipe.hair]))
    if recipe.hair == "bun":
        pieces.append(bun(sitter))
    if recipe.beard:
        pieces.append(beard(sitter))
    if recipe.glasses:
        pieces.append(glasses(sitter))
    return pieces
