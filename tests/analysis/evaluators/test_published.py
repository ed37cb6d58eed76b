import argparse
import json
import pickle
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from numpy.typing import NDArray

from analysis.evaluators.published import PublishedEvaluator, load_published
from analysis.evaluators.published_presets import PRESETS
from analysis.metrics.frechet import frechet_of_samples, published_distance
from motion.arrays import Floats
from motion.errors import InputError
from tests.analysis.evaluators.published_weights import write_checkpoint
from tests.generators.reference_weights import reference_weights
from tests.motion.random_clips import clip_of


def _error(features: NDArray[Any], expected: NDArray[Any]) -> float:
    """Return the largest error, in the size of the features where they are above 1."""
    return float(np.abs(features - expected).max() / max(1, np.abs(expected).max()))


@pytest.mark.slow
@pytest.mark.parametrize("preset", PRESETS)
def test_features_and_their_distance_match_the_authors_code(
    preset: str, reference: Path, tmp_path: Path
) -> None:
    shapes = json.loads((reference / f"{preset}_state_dict.json").read_text("utf-8"))
    if preset in ("beat", "talkshow"):  # Their decoders are large, and no feature uses them.
        shapes = {name: shape for name, shape in shapes.items() if "encoder" in name}
    evaluator = load_published(
        preset, write_checkpoint(tmp_path, preset, reference_weights(shapes))
    )
    with np.load(reference / f"{preset}_plain.npz") as file:
        expected = dict(file)
    for name, feature in {"motion": "feature", "clip": "clip_feature"}.items():
        if name in expected:
            features = evaluator.features(expected[name])
            assert features.shape == expected[feature].shape
            assert _error(features, expected[feature]) < 1e-4
    suffix = "_512" if preset == "beat" else "_64"
    with np.load(reference / f"{preset}_fgd.npz") as file:
        expected = dict(file)
    rows: list[Floats] = []
    for side, motion in zip("ab", _sets(preset, expected), strict=True):
        features = evaluator.features(motion).reshape(-1, evaluator.preset.features)
        assert _error(features, expected[f"features_{side}{suffix}"]) < 1e-4
        rows.append(features.astype(float))
    distance = float(expected[f"fgd{suffix}"])
    one, other = rows
    assert frechet_of_samples(one, other) == pytest.approx(distance, rel=1e-3)
    # The reference took float32 features, as the published code does.
    assert published_distance(one, other, evaluator.rule) == pytest.approx(distance, rel=1e-5)


def _sets(preset: str, stored: Mapping[str, NDArray[Any]]) -> tuple[NDArray[Any], NDArray[Any]]:
    if preset == "ted":
        return stored["windows_a_64"], stored["windows_b_64"]
    shape, one, shift, other = {
        "emage": ((64, 64, 330), 0.5, 0.05, 0.65),
        "beat": ((512, 34, 141), 1.0, 0.1, 1.3),
        "talkshow": ((64, 88, 129), 0.3, 0.03, 0.39),
    }[preset]
    first, second = (np.random.default_rng(seed).standard_normal(shape) for seed in (101, 202))
    return one * first, shift + other * second


@pytest.fixture
def ted(tmp_path: Path) -> PublishedEvaluator:
    return load_published("ted", write_checkpoint(tmp_path, "ted"))


def test_data_parallel_and_plain_weights_give_the_same_network(
    ted: PublishedEvaluator, tmp_path: Path
) -> None:
    motion = np.random.default_rng(0).standard_normal((3, 34, 27))
    weights = ted.network.state_dict()
    for name, content in {
        "prefixed": {"gen_dict": {f"module.{key}": value for key, value in weights.items()}},
        "alone": dict(weights),
        "with decoder": {"gen_dict": {**weights, "decoder.net.0.weight": torch.zeros(3)}},
    }.items():
        torch.save(content, tmp_path / name)
        again = load_published("ted", tmp_path / name)
        np.testing.assert_array_equal(again.features(motion), ted.features(motion))


def test_options_of_a_training_script_load_and_other_objects_run_no_code(tmp_path: Path) -> None:
    class Harm:
        def __reduce__(self) -> tuple[Any, ...]:
            return (Path.touch, (tmp_path / "harm",))

    options = argparse.Namespace(n_poses=34, name="pose", mean_dir_vec=[0.1, 0.2])
    path = write_checkpoint(tmp_path, "ted", args=options, epoch=3, pose_dim=27)
    assert load_published("ted", path).features(np.zeros((1, 34, 27))).shape == (1, 32)
    plain = tmp_path / "trap.bin"
    plain.write_bytes(pickle.dumps({"gen_dict": Harm()}, protocol=2))
    for args in (None, Harm(), argparse.Namespace(share=Fraction(1, 3))):
        other = write_checkpoint(tmp_path, "ted", args=args) if args else plain
        with pytest.raises(InputError, match="not a file of network weights") as refused:
            load_published("ted", other)
        assert "torch.save" in str(refused.value.remedy)
    assert not (tmp_path / "harm").exists()


def test_files_other_than_the_presets_checkpoint_are_refused(tmp_path: Path) -> None:
    ted = write_checkpoint(tmp_path, "ted")
    (tmp_path / "cut.bin").write_bytes(ted.read_bytes()[:5000])
    torch.save([1, 2], tmp_path / "list.bin")
    small = PRESETS["ted"].network().state_dict()
    small["pose_encoder.net.0.0.weight"] = torch.zeros(32, 30, 3)
    torch.save({"gen_dict": small}, tmp_path / "small.bin")
    for preset, file, said in (
        ("tde", ted, "unknown published evaluator 'tde'"),
        ("ted", tmp_path / "none.bin", "no such file"),
        ("ted", tmp_path / "cut.bin", "not a file of network weights"),
        ("ted", tmp_path / "list.bin", "no named weights"),
        ("ted", tmp_path / "small.bin", r"\[32, 30, 3\].*\[32, 27, 3\]"),
        ("emage", ted, "encoder.layers.0.0.residual.0.mask"),
    ):
        with pytest.raises(InputError, match=said):
            load_published(preset, file)


def test_motion_that_a_network_cannot_use_is_refused(ted: PublishedEvaluator) -> None:
    unusable = np.full((1, 34, 27), np.nan)
    for motion in (np.zeros((34, 27)), np.zeros((1, 33, 27)), np.zeros((1, 34, 30)), unusable):
        with pytest.raises(InputError, match=r"shape .* or a value that is not finite"):
            ted.features(motion)


def test_clips_are_cut_into_the_authors_windows(ted: PublishedEvaluator, tmp_path: Path) -> None:
    emage = load_published("emage", write_checkpoint(tmp_path, "emage"))
    for evaluator, frames, rate, rows in (
        (ted, 41, 15.0, None),
        (ted, 42, 15.0, 1),
        (ted, 62, 15.0, 3),
        (ted, 124, 30.0, 3),
        (emage, 31, 30.0, None),
        (emage, 75, 30.0, 4),
        (emage, 64, 15.0, 8),
    ):
        clip = clip_of(np.zeros((frames, 55, 3)), frame_rate=rate)
        if rows is None:
            with pytest.raises(InputError, match="s at least"):
                evaluator.embed(clip)
        else:
            assert evaluator.embed(clip).shape == (rows, evaluator.preset.features)


def test_beat_clips_are_normalised_by_the_named_frames(tmp_path: Path) -> None:
    path = write_checkpoint(tmp_path, "beat")
    clip = clip_of(np.zeros((40, 55, 3)), frame_rate=15)
    with pytest.raises(InputError, match="mean and spread are not given"):
        load_published("beat", path).embed(clip)
    random = np.random.default_rng(0)
    mean, spread = random.normal(0, 5, 141), random.uniform(1, 2, 141)
    spread[:10] = 1e-5
    folder = tmp_path / "stats"
    folder.mkdir()
    np.save(folder / "bvh_mean.npy", mean)
    for unusable in (None, np.array([None] * 141), np.zeros(140), np.full(141, np.nan)):
        if unusable is not None:
            np.save(folder / "bvh_std.npy", unusable, allow_pickle=True)
        with pytest.raises(InputError, match="not an array of 141 finite numbers"):
            load_published("beat", path, statistics=folder)
    np.save(folder / "bvh_std.npy", spread)
    beat = load_published("beat", path, statistics=folder)
    assert beat.sha256 != load_published("beat", path).sha256
    frames = PRESETS["beat"].frames(clip)[:34]
    seen = np.where(np.isnan(frames) | (spread < 1e-3), 0, (frames - mean) / spread)
    np.testing.assert_allclose(beat.embed(clip), beat.features(seen[None]), atol=1e-4)
