"""Make the study of three systems, and its page: ``python -m tools.three_systems``.

Everything is in one folder. An interrupted run resumes, and replacing a network repeats the steps
that depend on it.
"""

import argparse
import os
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import tomlkit

from motion.errors import InputError
from motion.files import digest, write_text
from studyapp.study.folder import StudyFolder
from tools.markdown import write_part
from tools.three_systems.line import Line, places
from tools.three_systems.networks import NETWORKS, Network, evaluators, networks
from tools.three_systems.page import measured
from tools.three_systems.takes import (
    bring,
    learned_takes,
    shown_segment,
    shown_takes,
    write_picture,
)
from training.data.folders import read_takes

STUDY: Final = "study"
RECORDINGS: Final = "recordings"
TEMPLATE: Final = "three-systems"

CORPUS: Final = (
    *("--shared-passages", "--takes", "1", "--sentences", "40"),
    *("--speakers", "7", "--held-out-speakers", "1"),
)
LEARNED_FROM: Final = 12
"""Takes of each emotion for training feature networks."""

SIZE: Final = 360
FRAME_RATE: Final = 15
"""Size and frame rate of the videos: small, and the frame rate of two of the three systems."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the missing steps, and write the page and its pictures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, default=Path("build/three-systems"))
    parser.add_argument(
        "--write",
        type=Path,
        help="the page whose measured part is updated; printed by default",
    )
    parser.add_argument("--corpus", type=Path, help="an existing corpus; made by default")
    for name in NETWORKS:
        parser.add_argument(f"--{name}", type=Path, help="its network; trained by default")
    parser.add_argument(
        "--steps", type=int, help="steps of each network instead of its tiny config's"
    )
    parser.add_argument("--evaluator-steps", type=int, help="steps of each feature network")
    parser.add_argument("--segments", type=int, default=2, help="of each emotion")
    parser.add_argument("--participants", type=int, default=60, help="simulated ones")
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    args = parser.parse_args(arguments)
    try:
        line, trained = make(args)
    except InputError as error:
        raise SystemExit(f"Error: {error}") from error
    study = StudyFolder(line.folder / STUDY)
    text = measured(study, line.took(), trained)
    if args.write is None:
        print(text)
        return
    write_part(args.write, "measured", text)
    for kind in ("bodies", "faces"):
        picture = args.write.with_name(f"{args.write.stem}-{kind}.png")
        write_picture(line.folder / f"{kind}.png", picture)


def make(args: argparse.Namespace) -> tuple[Line, list[Network]]:
    """Make the missing parts of the study, from the corpus to the report."""
    root: Path = args.folder.resolve()
    root.mkdir(parents=True, exist_ok=True)
    line = Line(root)
    corpus = root / "corpus" if args.corpus is None else args.corpus.resolve()
    if args.corpus is None:
        line.run("corpus", *places([corpus], root), *CORPUS)
    given: dict[str, Path | None] = {
        name: getattr(args, name.replace("-", "_")) for name in NETWORKS
    }
    trained = networks(line, corpus, given, args.steps)
    takes = read_takes(corpus).takes
    study, recordings = StudyFolder(root / STUDY), StudyFolder(root / RECORDINGS)
    for folder, chosen in (
        (recordings, learned_takes(takes, LEARNED_FROM)),
        (study, shown_takes(takes, args.segments)),
    ):
        if not folder.definition.exists():
            line.run("init", *places([folder.root], root), "--template", TEMPLATE)
        _set(folder, args.participants)
        with line.step(f"import of {len(chosen)} recordings") as is_due:
            if is_due:
                bring(folder, chosen)
    evaluators(line, RECORDINGS, study.evaluators, args.evaluator_steps)
    depends = digest(*(network.file for network in trained))
    _place(study, trained)
    processes = ("--processes", str(args.processes))
    line.run("generate", STUDY, of=depends)
    line.run("render", STUDY, *processes, of=depends)
    line.run("check", STUDY, of=depends)
    line.run("rehearse", STUDY, of=depends)
    line.run("metrics", STUDY, *processes, of=depends)
    line.run("report", STUDY, of=depends)
    segment = shown_segment(study)
    strip = ("figure", "strip", STUDY, "--segment", segment, "--moments", "5", "--inches", "3.3")
    line.run(*strip, "--output", "bodies.png", of=depends)
    line.run(*strip, "--closeup", "--no-wave", "--output", "faces.png", of=depends)
    return line, trained


def _set(folder: StudyFolder, participants: int) -> None:
    """Write what differs from the template: few and small frames, and settings for the checks."""
    document: Any = tomlkit.parse(folder.definition.read_text("utf-8"))
    document["title"] = "Which speaker moves better?"
    document["participants"] = participants
    document["layout"] = "players"
    document["video"]["size"] = SIZE
    document["video"]["frame_rate"] = FRAME_RATE
    write_text(folder.definition, tomlkit.dumps(document))


def _place(study: StudyFolder, trained: Sequence[Network]) -> None:
    """Copy the networks to the template's paths."""
    folder = study.root / "networks"
    folder.mkdir(exist_ok=True)
    for network in trained:
        shutil.copyfile(network.file, folder / f"{network.name}.safetensors")


if __name__ == "__main__":
    main()
