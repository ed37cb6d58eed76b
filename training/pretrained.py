"""Networks that `transformers` saved in a folder; nothing is fetched, and no pickle is read."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from safetensors import SafetensorError

from motion.errors import InputError

if TYPE_CHECKING:
    from transformers import PreTrainedModel

WEIGHTS: Final = "model.safetensors"
CONFIG: Final = "config.json"


@dataclass(frozen=True, kw_only=True)
class SavedNetworks:
    """Which networks a folder may hold, and what to say where it holds none of them.

    Attributes
    ----------
    whose : str
        Whose weights they are.
    types : mapping of str to str
        Their types, as ``config.json`` calls them, and their names.
    remedy : str
        How to come by such a folder.
    unasked : collection of str
        Weights that may be missing, by the beginnings of their names.
    """

    whose: str
    types: Mapping[str, str]
    remedy: str
    unasked: Collection[str] = ()

    def check(self, folder: Path) -> Mapping[str, Any]:
        """Return what ``config.json`` says of the network; its weights are not loaded.

        Raises
        ------
        InputError
            If a file is missing, or the network is another one.
        """
        for name in (CONFIG, WEIGHTS):
            if not (folder / name).is_file():
                raise self.refused(f"the folder of {self.whose} holds no {name}", folder)
        path = folder / CONFIG
        try:
            facts = json.loads(path.read_text(encoding="utf-8"))
        except ValueError as error:
            raise self.refused("the file is not JSON", path) from error
        kind = facts.get("model_type") if isinstance(facts, dict) else None
        if kind not in self.types:
            wanted = " or ".join(self.types.values())
            raise self.refused(f"the folder holds a network of type {kind!r}, not {wanted}", path)
        return dict(facts)

    def load(self, folder: Path) -> PreTrainedModel:
        """Return the network that ``save_pretrained`` wrote.

        Raises
        ------
        InputError
            If the folder holds no such network, or lacks a weight.
        """
        self.check(folder)
        from transformers import AutoModel

        try:
            network, report = AutoModel.from_pretrained(
                folder, local_files_only=True, use_safetensors=True, output_loading_info=True
            )
        except (SafetensorError, OSError, ValueError, RuntimeError, KeyError, TypeError) as error:
            what = str(error).partition("\n")[0]
            raise self.refused(f"the weights of {self.whose} cannot be read: {what}", folder) from (
                error
            )
        missing = sorted(
            name for name in report["missing_keys"] if not name.startswith(tuple(self.unasked))
        )
        if missing:
            raise self.refused(
                f"the file of {self.whose} lacks {len(missing)} weights ({', '.join(missing[:3])})",
                folder / WEIGHTS,
            )
        return network

    def refused(self, what: str, where: Path) -> InputError:
        """Return the error for a folder that does not hold what is wanted."""
        return InputError(what, where=where, remedy=self.remedy)
