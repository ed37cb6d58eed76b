"""Takes of TED Gesture and of BEAT are told alike."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motion.audio import Audio, write_wav
from motion.errors import InputError
from motion.formats.ted_npz import AXES
from tests.generators.s2ue.small_network import FACE, standing
from tests.training.takes import take_named
from training.data.take import Kind, Take
from training.features import features_of
from training.hearing.word_vectors import StandIn


def take(folder: Path, **files: Path) -> Take:
    chance = np.random.default_rng(1)
    write_wav(
        folder / "a.wav", Audio(0.1 * chance.standard_normal(32000).astype(np.float32), 16000)
    )
    directions = np.tile(standing()[:27].reshape(9, 3) * AXES, (30, 1, 1))
    np.savez(folder / "a.npz", directions=directions)
    return take_named("a", folder, motion=folder / "a.npz", **files)


def computed(kind: Kind, one: Take, *, faces: bool) -> dict[str, np.ndarray]:
    features = features_of(kind, FACE, StandIn(), 15.0, faces=faces)
    return {feature.name: feature.compute(one) for feature in features}


def test_ted_gesture_is_turned_into_our_axes_and_has_a_still_face(tmp_path: Path) -> None:
    (tmp_path / "a.lab").write_text("hello there")
    found = computed("ted", take(tmp_path, transcript=tmp_path / "a.lab"), faces=False)
    assert {name: one.shape for name, one in found.items()} == {
        "motion": (30, 27 + 3 * FACE.count),
        "sound": (30, 84),
        "spectrum": (30, 128),
        "words": (30, 300),
    }
    np.testing.assert_allclose(found["motion"][7, :27], standing()[:27], atol=1e-5)
    assert not found["motion"][:, 27:].any()
    assert len(np.unique(found["words"], axis=0)) == 2


def test_a_take_of_beat_without_a_face_says_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no facial weights.*--ablation without_face"):
        computed("beat", take(tmp_path), faces=True)
