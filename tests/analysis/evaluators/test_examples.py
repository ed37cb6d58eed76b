from __future__ import annotations

import numpy as np
import torch

from analysis.evaluators.examples import Split, split


def parts(recordings: list[str], labels: list[str], frames: int = 50) -> Split:
    """Return the split of clips whose frames count on, so that a frame tells its place."""
    clips = [
        np.arange(number * 1000, number * 1000 + frames, dtype=np.float32)[:, None]
        for number in range(len(recordings))
    ]
    return split(
        clips,
        recordings,
        labels,
        names=sorted(set(labels)),
        window=10,
        stride=5,
        floor=np.full(1, 0.01, np.float32),
        seed=0,
        device="cpu",
    )


def places(found: Split, rows: np.ndarray, *, held_out: bool = False) -> np.ndarray:
    """Return the frames of windows as they were counted."""
    examples = found.held_out if held_out else found.training
    windows, _ = examples.batch(rows)
    norm = found.normalisation
    return np.rint(windows[:, :, 0].numpy() * norm.deviation + norm.mean)


def test_no_window_crosses_from_one_clip_into_the_next() -> None:
    found = parts([f"r{n}" for n in range(10)], ["x"] * 10)
    for held_out, examples in ((False, found.training), (True, found.held_out)):
        counted = places(found, np.arange(len(examples)), held_out=held_out)
        np.testing.assert_array_equal(np.diff(counted, axis=1), 1)
    assert (len(found.training), len(found.held_out)) == (8 * 9, 2 * 9)


def test_no_recording_is_both_learned_from_and_kept_back() -> None:
    found = parts([f"r{n // 2}" for n in range(20)], ["x"] * 20)
    learned = set(places(found, np.arange(len(found.training)))[:, 0] // 2000)
    kept_back = set(places(found, np.arange(len(found.held_out)), held_out=True)[:, 0] // 2000)
    assert learned.isdisjoint(kept_back)
    assert (found.recordings, found.how) == (10, "2 of 10 recordings")


def test_one_recording_is_split_in_time_without_overlap() -> None:
    found = parts(["r"], ["x"], frames=100)
    learned = places(found, np.arange(len(found.training)))
    kept_back = places(found, np.arange(len(found.held_out)), held_out=True)
    assert learned.max() < 80 <= kept_back.min()
    assert found.how == "the last fifth of every clip, since there is one recording"


def test_labels_go_with_their_windows() -> None:
    found = parts([f"r{n}" for n in range(4)], ["y", "x", "y", "x"])
    windows, labels = found.training.batch(np.arange(len(found.training)))
    norm = found.normalisation
    clip = torch.round(windows[:, 0, 0] * norm.deviation[0] + norm.mean[0]) // 1000
    assert torch.equal(labels, (clip % 2 == 0).long())


def test_what_is_kept_back_does_not_shape_the_normalisation() -> None:
    found = parts(["r"], ["x"], frames=100)
    np.testing.assert_allclose(found.normalisation.mean, np.arange(80).mean())
    np.testing.assert_allclose(found.normalisation.deviation, np.arange(80).std(), rtol=1e-5)
