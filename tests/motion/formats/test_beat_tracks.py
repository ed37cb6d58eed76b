import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion.clip import arkit_index
from motion.errors import InputError
from motion.formats.beat_tracks import (
    SemanticSpan,
    read_arkit_json,
    read_semantic_scores,
    semantic_weights,
    write_arkit_json,
)


def face(
    path: Path,
    weights: np.ndarray,
    names: tuple[str, ...] = ("tongueOut", "BrowDownLeft"),
    **extra: Any,
) -> Path:
    frames = [
        {"weights": row.tolist(), "time": k / 60, "rotation": []} for k, row in enumerate(weights)
    ]
    path.write_text(json.dumps({"names": list(names), "frames": frames, **extra}))
    return path


@given(frames=st.integers(2, 200), rate=st.sampled_from([12.5, 15, 25, 30, 60, 120]))
def test_every_rate_keeps_time_and_every_name_its_column(
    tmp_path_factory: pytest.TempPathFactory, frames: int, rate: float
) -> None:
    ramp = np.arange(frames) / 60 / 4
    path = face(tmp_path_factory.mktemp("face") / "a.json", np.stack([ramp, 1 - ramp], axis=1))
    result = read_arkit_json(path, rate)
    assert len(result) == pytest.approx(max(1, frames / 60 * rate), abs=0.5 + 1e-6)
    times = np.minimum(np.arange(len(result)) / rate, (frames - 1) / 60)
    expected = np.zeros((len(result), 52))
    expected[:, arkit_index("tongueOut")] = times / 4
    expected[:, arkit_index("browDownLeft")] = 1 - times / 4
    np.testing.assert_allclose(result, expected, atol=1e-6)


def test_small_overshoot_is_clipped(tmp_path: Path) -> None:
    path = face(tmp_path / "a.json", np.array([[1.02, -0.01], [1.0, 0.0]]))
    result = read_arkit_json(path, 60)
    assert result.min() == 0
    assert result.max() == 1


GOOD = np.full((3, 2), 0.5)


@pytest.mark.parametrize(
    ("weights", "options", "complaint"),
    [
        (GOOD * 100, {}, r"weights lie in \[50, 50\]"),
        (GOOD[:, :1], {}, "does not have 2 weights"),
        (GOOD, {"names": ("jawOpen", "smirk")}, "unknown facial actions smirk"),
        (GOOD, {"names": ("jawOpen", "JawOpen")}, "occurs twice"),
        (GOOD, {"frames": []}, "not JSON of facial weights .frames: "),
        (GOOD * np.nan, {}, "not JSON of facial weights"),
        *(
            (GOOD, {"frames": [{"weights": [0, 0], "time": t} for t in times]}, "times of 3 frames")
            for times in ((0, 0.1, 0.1), (0, 17, 1e15))
        ),
    ],
)
def test_unusable_content_is_refused_by_name(
    tmp_path: Path, weights: np.ndarray, options: dict[str, Any], complaint: str
) -> None:
    path = face(tmp_path / "bad.json", weights, **options)
    with pytest.raises(InputError, match=complaint) as caught:
        read_arkit_json(path, 30)
    assert caught.value.where == str(path)


def test_motion_survives_a_round_trip(tmp_path: Path) -> None:
    weights = np.random.default_rng(1).uniform(size=(7, 51))
    write_arkit_json(tmp_path / "a.json", weights, 60.0)
    back = read_arkit_json(tmp_path / "a.json", 60.0)
    np.testing.assert_allclose(back[:, :51], weights, atol=1e-4)
    assert not back[:, 51].any()


def test_annotations_are_read_as_beat_writes_them(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text(
        '01_beat_align\t0.0\t1.5\t1.5\t0.1\t\n\n05_iconic_h\t1.5\t2.0\t0.5\t0.9\tsay "big\n',
        encoding="utf-8",
    )
    assert read_semantic_scores(path) == (
        SemanticSpan(start=0.0, end=1.5, score=0.1),
        SemanticSpan(start=1.5, end=2.0, score=0.9),
    )


@pytest.mark.parametrize(
    "row", ["name\t0\t1", "name\tx\t1\t1\t0.5", "name\t2\t1\t1\t0.5", "name\t0\t1\t1\tnan"]
)
def test_a_malformed_annotation_is_refused_by_line(tmp_path: Path, row: str) -> None:
    path = tmp_path / "a.txt"
    path.write_text(f"ok\t0\t1\t1\t0.5\n{row}\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"a\.txt, line 2: the row is not an annotation"):
        read_semantic_scores(path)


def test_frames_get_the_largest_score_of_their_spans() -> None:
    spans = (
        SemanticSpan(start=0.5, end=1.5, score=0.2),
        SemanticSpan(start=1.0, end=2.0, score=0.7),
    )
    assert semantic_weights(spans, 6, 2.0).tolist() == [0, 0.2, 0.7, 0.7, 0, 0]
