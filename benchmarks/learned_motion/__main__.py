"""Compare trained DiffSHEG with all else: ``python -m benchmarks.learned_motion``.

Makes a corpus, trains feature networks and DiffSHEG on it, moves to its test takes, measures, and
writes a page. Everything lies in one folder, and a run that was interrupted goes on from there.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Final

from analysis.metrics import network_names as names
from benchmarks.learned_motion.compared_study import (
    MISMATCHED,
    RULE_BASED,
    UNTRAINED,
    trained_name,
    write_study,
)
from benchmarks.learned_motion.comparison import followings, score_of, verdicts
from benchmarks.learned_motion.networks import (
    train_evaluators,
    train_network,
    write_untrained,
)
from benchmarks.learned_motion.page import page
from benchmarks.learned_motion.recordings import FRAME_RATE, write_recordings
from benchmarks.learned_motion.truth import speeches, spoken
from generators.diffsheg.generate import DiffSheg
from generators.diffsheg.network_file import load_network
from motion.files import write_text
from studyapp.command.progress import progress
from studyapp.definition.study import GROUND_TRUTH
from studyapp.stages.generation import generate
from studyapp.stages.measuring import measure_study
from training.corpus.description import read_request
from training.corpus.making import make_corpus
from training.corpus.process import VERSION
from training.corpus.request import CorpusRequest
from training.data.any_folder import read_takes
from training.data.take import Take

PRESETS: Final = ("report", "amuse", "beat")

SENTENCES: Final = 64
"""Passages of each speaker, four times as many as a corpus usually has: of fewer a network learns
whole sentences by heart before it finds the strokes in speech that it never heard."""

TEST_TAKES: Final = 200


def main(arguments: Sequence[str] | None = None) -> None:
    """Run what is missing, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, default=Path("build/learned-motion"))
    parser.add_argument("--write", type=Path, help="the page; printed where left out")
    parser.add_argument("--corpus", type=Path, help="one that is there, in place of making one")
    parser.add_argument("--sentences", type=int, default=SENTENCES, help="that each speaker says")
    parser.add_argument("--test-takes", type=int, default=TEST_TAKES, help="that are moved to")
    parser.add_argument("--seeds", type=int, default=3, help="how many networks are trained")
    parser.add_argument("--steps", type=int, help="of each network, in place of the config's")
    parser.add_argument("--evaluator-steps", type=int, help="of each feature network")
    given = parser.parse_args(arguments)
    text = compare(given)
    if given.write is None:
        print(text)
    else:
        write_text(given.write, text)


def compare(given: argparse.Namespace) -> str:
    """Return the page of a comparison, making what its folder lacks."""
    corpus = given.corpus or given.folder / f"corpus_{given.sentences}"
    if given.corpus is None:
        wanted = CorpusRequest(sentences=given.sentences)
        with progress("corpus", "take") as show:
            make_corpus(corpus, wanted, processes=os.cpu_count() or 1, show=show)
    takes = read_takes(corpus)
    root: Path = given.folder / f"diffsheg_{DiffSheg.version}_{read_request(corpus).sentences}"
    test = evenly([take for take in takes.takes if take.split == "test"], given.test_takes)
    networks = {}
    for seed in range(1, given.seeds + 1):
        networks[trained_name(seed)] = out = root / f"{trained_name(seed)}.safetensors"
        with progress(f"train {seed}", "step") as show:
            train_network(
                takes, out, given.folder / "features", seed=seed, steps=given.steps, show=show
            )
    trained = tuple(networks)
    networks[UNTRAINED] = root / f"{UNTRAINED}.safetensors"
    write_untrained(networks[trained[0]], networks[UNTRAINED], seed=1)
    learned_from = [take for take in takes.takes if take.split != "test"]
    evaluators = train_evaluators(
        learned_from,
        write_recordings(learned_from, lambda take: root / "recordings" / f"{take.name}.npz"),
        root / "evaluators",
        steps=given.evaluator_steps,
    )
    folder = write_study(root / "study", test, networks, seed=1)
    with progress("generate", "clip") as show_clip:
        generate(folder, on_clip=show_clip)
    with progress("measure", "step") as show_steps:
        metrics = measure_study(
            folder, presets=PRESETS, processes=1, evaluators=evaluators, on_progress=show_steps
        )
    order = (GROUND_TRUTH, MISMATCHED, RULE_BASED, UNTRAINED, *trained)
    found = followings(folder, order, speeches(corpus, test), spoken(corpus, test), seed=1)
    distance = partial(score_of, metrics, beginning=names.FGD)
    judged = verdicts({name: distance(name) for name in order}, found, trained)
    return page(metrics, found, judged, _facts(corpus, len(test), networks))


def evenly(takes: Sequence[Take], count: int) -> list[Take]:
    """Return `count` takes that lie evenly among `takes`; all where there are not so many."""
    wanted = min(count, len(takes))
    return [takes[number * len(takes) // wanted] for number in range(wanted)]


def _facts(corpus: Path, tests: int, networks: dict[str, Path]) -> list[str]:
    made = read_request(corpus)
    steps = [
        str(load_network(file, "beat", None).training["config"]["steps"])
        for name, file in networks.items()
        if name != UNTRAINED
    ]
    return [
        f"Corpus: {made.speakers} speakers, {made.sentences} passages each in {made.takes} takes, "
        f"seed {made.seed}, version {VERSION} of the process; {tests} test takes.",
        f"Everything is measured at {FRAME_RATE} frames per second on one body; recorded motion "
        "goes through the same steps as a network's.",
        f"Trained networks: DiffSHEG's tiny config, {' and '.join(sorted(set(steps)))} steps; "
        "HuBERT is the stand-in. Sampling: the default, `smooth`.",
        "Feature networks: the tiny autoencoders of `motionjury train evaluator motion`, trained "
        "on the recordings that DiffSHEG learned from.",
        "Beat alignment: preset `amuse` (docs/metrics.md).",
    ]


if __name__ == "__main__":
    main()
