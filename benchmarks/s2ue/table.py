"""Speech2UnifiedExpressions and its ablations on a corpus, as in the paper's Table 1."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from statistics import mean

import numpy as np
import torch
from numpy.typing import NDArray

from benchmarks.s2ue.measures import COLUMNS, RATE, SEEDS, Measure
from generators.registry import TrainingRequest
from generators.s2ue.model import S2ueNetwork, load_network
from generators.s2ue.train import train_s2ue
from motion.body.face_landmarks import FaceLandmarks
from training.data.feature_cache import prepare
from training.data.folders import read_takes
from training.data.take import Split, TakeFolder
from training.data.windows import Windows
from training.features import bone_features
from training.speech_features.word_vectors import StandIn

FloatArray = NDArray[np.float64]
Found = Mapping[str, float]


def table(
    corpus: Path, folder: Path, *, steps: int, seeds: int, ablations: Sequence[str]
) -> Iterator[str]:
    """Yield the rows of the table, training what `folder` lacks.

    Parameters
    ----------
    corpus : Path
        A corpus made by 'motionjury corpus'.
    folder : Path
        Holds features and networks: an interrupted call resumes.
    steps : int
        Steps of each training run.
    seeds : int
        Training runs of each variant; cells hold their mean and range.
    ablations : sequence of str
        Members of `generators.s2ue.config.ABLATIONS` to compare with the full model.
    """
    takes, face = read_takes(corpus), FaceLandmarks.of_default_body()
    recorded = windows_of(takes, folder, "test", stride=34)
    measure = Measure(recorded, windows_of(takes, folder, "train", stride=10), face)
    files = {
        (ablation, seed): folder / f"{steps}_steps" / f"{ablation or 'full'}_{seed}.safetensors"
        for seed in range(seeds)
        for ablation in (None, *ablations)
    }
    for (ablation, seed), out in files.items():
        if not out.exists():
            _train(takes, folder / "features", out, ablation, steps, seed)
    yield f"| | {' | '.join(COLUMNS)} |"
    yield f"|---{'|---' * len(COLUMNS)}|"
    for ablation in (*ablations, None):
        rows_of_seeds = []
        for seed in range(seeds):
            network = load_network(files[ablation, seed], face)
            config = network.model.config
            generated = _generated(network, recorded)
            rows_of_seeds.append(measure(generated, face=config.faces, pose=config.poses))
        yield _row((ablation or "full model").replace("_", " "), rows_of_seeds)
    for name, values in _recordings(recorded).items():
        score = measure.synchrony(measure.recorded[:, SEEDS:], values[:, SEEDS:])
        yield _row(name, [dict.fromkeys(COLUMNS, float("nan")) | {"synchrony": score}])


def windows_of(takes: TakeFolder, folder: Path, split: Split, *, stride: int) -> Windows:
    """Return windows of a corpus with the networks' inputs, which are cached in `folder`."""
    face = FaceLandmarks.of_default_body()
    features = bone_features(takes.kind, face, StandIn(), RATE, faces=True)
    prepared = prepare(takes, features, folder / "features", frame_rate=RATE)
    return Windows(prepared, split=split, frames=34, stride=stride)


def _recordings(windows: Windows) -> Mapping[str, FloatArray]:
    """Return recorded bodies for the recorded faces: their own, and those of other takes."""
    chance = np.random.default_rng(1)
    motion = windows.batch(np.arange(len(windows)))["motion"].astype(np.float64)
    takes = [windows.take_of(row) for row in range(len(windows))]
    names, speakers = (
        np.array([getattr(take, what) for take in takes]) for what in ("name", "speaker")
    )

    def drawn(same: bool) -> FloatArray:
        fits = (names[:, None] != names) & ((speakers[:, None] == speakers) == same)
        return motion[[chance.choice(np.flatnonzero(entry)) for entry in fits]]

    return {
        "recorded": motion,
        "recorded, body of another take": drawn(same=True),
        "recorded, body of another speaker": drawn(same=False),
    }


def _train(
    takes: TakeFolder, cache: Path, out: Path, ablation: str | None, steps: int, seed: int
) -> None:
    request = TrainingRequest(
        takes=takes,
        out=out,
        cache=cache,
        config="tiny",
        changes={"steps": steps, "seed": seed, "validate_every": 50},
        choices={} if ablation is None else {"ablation": ablation},
    )
    train_s2ue(request)


def _generated(trained: S2ueNetwork, windows: Windows) -> FloatArray:
    """Return generated motion for all windows (windows, T, values), from recorded seeds."""
    network, config = trained.model, trained.model.config
    rows = np.arange(len(windows))
    inputs = {name: torch.from_numpy(entry) for name, entry in windows.batch(rows).items()}
    people = trained.speakers.one_hot(windows.speakers(rows))
    noise = torch.randn(
        (len(rows), *config.latents),
        generator=torch.Generator().manual_seed(1),
    )
    with torch.inference_mode():
        values, _ = network.synthesise(
            inputs["sound"],
            inputs["words"],
            torch.from_numpy(people),
            noise,
            inputs["motion"][:, : config.seeds],
        )
        values = network.with_lips(values, inputs["spectrum"])
    return values.numpy().astype(np.float64)


def _row(name: str, rows_of_seeds: Sequence[Found]) -> str:
    cells = (_cell([entry[column] for entry in rows_of_seeds]) for column in COLUMNS)
    return f"| {name} | {' | '.join(cells)} |"


def _cell(values: Sequence[float]) -> str:
    """Return the mean over seeds, with the range if there are several."""
    if np.isnan(values).any():
        return "–"
    middle, low, high = (f"{entry:.3g}" for entry in (mean(values), min(values), max(values)))
    return middle if len(values) == 1 else f"{middle} ({low}–{high})"
