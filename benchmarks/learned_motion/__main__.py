"""Compare trained DiffSHEG and AMUSE with the others: ``python -m benchmarks.learned_motion``.

Makes a corpus, trains feature networks and both systems on it, generates motion for its test takes,
measures it and writes a page. Everything is in one folder, and an interrupted run resumes.
"""

import argparse
import os
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Final

from analysis.evaluators import feature_networks as names
from benchmarks.learned_motion.compared_study import (
    MISMATCHED,
    RULE_BASED,
    UNTRAINED,
    write_study,
)
from benchmarks.learned_motion.comparison import edit_verdicts, followings, score_of, verdicts
from benchmarks.learned_motion.editing import (
    BY_NAME,
    BY_RECORDING,
    Edited,
    by_name,
    by_recording,
    edit,
)
from benchmarks.learned_motion.hearing import heard_apart
from benchmarks.learned_motion.networks import (
    ABLATIONS,
    SYSTEMS,
    Network,
    train_evaluators,
    train_network,
    write_untrained,
)
from benchmarks.learned_motion.page import Findings, page
from benchmarks.learned_motion.recordings import FRAME_RATE, write_recordings
from benchmarks.learned_motion.truth import speeches, spoken
from motion.files import write_text
from studyapp.cli.output import progress
from studyapp.results.metrics import measure_study
from studyapp.stimuli.generation import generate
from studyapp.study.settings.study import GROUND_TRUTH
from training.corpus.making import make_corpus
from training.corpus.plan import CorpusRequest
from training.corpus.process import VERSION
from training.data.folders import read_takes
from training.data.take import Take
from training.weights_file import read_weights

PRESETS: Final = ("report", "amuse", "beat")

SPEAKERS: Final = 6
SENTENCES: Final = 96
"""Passages that all speakers speak; with fewer, a network memorises whole sentences before it
learns strokes that generalise."""

EDITED: Final = 32
"""Test takes for which motion is generated in each of the other seven emotions."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the missing steps, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, default=Path("build/learned-motion"))
    parser.add_argument("--write", type=Path, help="the page; printed by default")
    parser.add_argument("--sentences", type=int, default=SENTENCES, help="sentences per speaker")
    parser.add_argument("--seeds", type=int, default=3, help="networks of each system")
    parser.add_argument(
        "--ablations",
        nargs="*",
        default=ABLATIONS,
        choices=ABLATIONS,
        help="ablations of AMUSE, one seed each",
    )
    parser.add_argument("--steps", type=int, help="steps of each network instead of the config's")
    parser.add_argument("--evaluator-steps", type=int, help="steps of each feature network")
    args = parser.parse_args(arguments)
    text = compare(args)
    if args.write is None:
        print(text)
    else:
        write_text(args.write, text)


def compare(args: argparse.Namespace) -> str:
    """Return the page of a comparison, creating what its folder lacks."""
    root: Path = args.folder
    corpus, cache = root / "corpus", root / "features"
    wanted = CorpusRequest(
        speakers=SPEAKERS,
        sentences=args.sentences,
        takes=1,
        held_out_speakers=0,
        shared_passages=True,
    )
    with progress("corpus", "take") as show:
        make_corpus(corpus, wanted, processes=os.cpu_count() or 1, show=show)
    takes = read_takes(corpus)
    test = [take for take in takes.takes if take.split == "test"]
    systems = {
        system: [Network(system=system, seed=seed) for seed in range(1, args.seeds + 1)]
        for system in SYSTEMS
    }
    ablated = [Network(system="amuse", seed=1, ablation=ablation) for ablation in args.ablations]
    networks = [*systems["diffsheg"], *systems["amuse"], *ablated]
    for network in networks:
        train_network(takes, network, root, cache=cache, steps=args.steps)
    untrained = root / f"{UNTRAINED}.safetensors"
    write_untrained(systems["diffsheg"][0].file(root), untrained)
    learned_from = [take for take in takes.takes if take.split != "test"]
    recordings = write_recordings(
        learned_from, lambda take: root / "recordings" / f"{take.name}.npz"
    )
    judges = train_evaluators(
        learned_from, recordings, root / "evaluators", steps=args.evaluator_steps
    )
    generators: dict[str, dict[str, str | Path]] = {
        UNTRAINED: {"generator": "diffsheg", "checkpoint": untrained}
    }
    generators |= {
        network.name: {"generator": network.system, **network.files(root)} for network in networks
    }
    folder = write_study(root / "study", test, generators, seed=1)
    with progress("generate", "clip") as show_clip:
        generate(folder, on_clip=show_clip)
    with progress("measure", "step") as show_steps:
        metrics = measure_study(
            folder,
            presets=PRESETS,
            processes=1,
            evaluators=[file for name, file in judges.items() if name != "speaker"],
            on_progress=show_steps,
        )
    order = (GROUND_TRUTH, MISMATCHED, RULE_BASED, *generators)
    speech, texts = speeches(corpus, test), spoken(corpus, test)
    found = followings(folder, order, speech, texts, seed=1)
    distance = partial(score_of, metrics, beginning=names.FGD)
    distances = {name: distance(name) for name in order}
    judged = {
        system: verdicts(distances, found, [one.name for one in trained])
        for system, trained in systems.items()
    }
    heard = {
        network.name: heard_apart(takes, network.hears_by.file(root), cache)
        for network in systems["amuse"]
        if network.hears_by is not None
    }
    ways = {BY_NAME: by_name, BY_RECORDING: by_recording(test, texts)}
    edits = [(way, network) for way in ways for network in systems["amuse"]]
    edited: dict[str, dict[str, Edited]] = {way: {} for way in ways}
    shown = evenly(test, EDITED)
    with progress("edit", "network") as show:
        for number, (way, network) in enumerate(edits):
            edited[way][network.name] = edit(network, root, shown, speech, texts, judges, ways[way])
            show(number + 1, len(edits), f"{way} {network.name}")
    for way, networks_of_way in edited.items():
        judged["amuse"] += edit_verdicts(way, list(networks_of_way.values()))
    return page(
        Findings(metrics=metrics, followed=found, judged=judged, heard=heard, edited=edited),
        _facts(wanted, len(test), networks, root),
    )


def evenly(takes: Sequence[Take], count: int) -> list[Take]:
    """Return `count` takes spread evenly over `takes`, or all if there are fewer."""
    wanted = min(count, len(takes))
    return [takes[number * len(takes) // wanted] for number in range(wanted)]


def _facts(made: CorpusRequest, tests: int, networks: Sequence[Network], root: Path) -> list[str]:
    steps = {
        network.system: read_weights(network.file(root)).facts["training"]["config"]["steps"]
        for network in networks
    }
    return [
        f"Corpus: {made.speakers} speakers, who all speak the same {made.sentences} passages; seed "
        f"{made.seed}, version {VERSION} of the process. The {tests} test takes are made of "
        "sentences that are spoken nowhere else.",
        f"Everything is measured at {FRAME_RATE} frames per second on one body; recorded motion "
        "goes through the same steps as DiffSHEG's.",
        "Tiny configs. Steps: "
        + ", ".join(f"{system} {count}" for system, count in steps.items())
        + ". HuBERT is the stand-in. DiffSHEG samples by its default, `smooth`. Ablations are of "
        "seed 1 alone.",
        "Feature networks: the tiny autoencoders of `motionjury train evaluator motion`, and the "
        "tiny classifier of `motionjury train evaluator emotion`, for emotions and for speakers, "
        "trained on the recordings that the systems learned from.",
        "Beat alignment: preset `amuse` (docs/metrics.md).",
    ]


if __name__ == "__main__":
    main()
