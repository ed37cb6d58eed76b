"""`motionjury corpus`."""

from __future__ import annotations

from pathlib import Path

import click

from motion.clip import MAX_FRAME_RATE, MIN_FRAME_RATE
from studyapp.cli.arguments import processes as processes_option
from studyapp.cli.output import counted, progress


@click.command("corpus")
@click.argument("folder", type=click.Path(path_type=Path, file_okay=False))
@click.option(
    "--speakers",
    type=click.IntRange(1),
    default=8,
    show_default=True,
    help="All speakers, those held out among them.",
)
@click.option(
    "--sentences",
    type=click.IntRange(8),
    default=16,
    show_default=True,
    help="Passages of each speaker, a multiple of eight: as many in each emotion.",
)
@click.option(
    "--takes",
    type=click.IntRange(1),
    default=2,
    show_default=True,
    help="How often each passage is spoken.",
)
@click.option(
    "--held-out-speakers",
    type=click.IntRange(0),
    default=2,
    show_default=True,
    help="The last speakers, whom no training hears.",
)
@click.option(
    "--shared-passages",
    is_flag=True,
    help="All speakers speak the same passages, which a speech model such as AMUSE's learns from.",
)
@click.option(
    "--fps",
    type=click.FloatRange(MIN_FRAME_RATE, MAX_FRAME_RATE),
    default=30.0,
    show_default=True,
    help="Frames per second of the body; the face has 60, as in BEAT.",
)
@click.option("--seed", type=click.IntRange(0), default=1, show_default=True)
@processes_option
def command(
    folder: Path,
    speakers: int,
    sentences: int,
    takes: int,
    held_out_speakers: int,
    shared_passages: bool,
    fps: float,
    seed: int,
    processes: int,
) -> None:
    """Make speech and motion with known truth in FOLDER, in the files and folders of BEAT.

    Passages in eight emotions are spoken by espeak-ng, and a process whose dependence on speech,
    emotion and speaker is written down (docs/corpus.md) moves to them. Networks can be trained and
    measured on it where there are no recordings; it says nothing about people.

    An interrupted run goes on when the same command is given, and the same options give the same
    bytes.
    """
    # Imported here: signal processing takes a second to load, which --help need not wait for.
    from training.corpus.making import make_corpus
    from training.corpus.request import CorpusRequest

    request = CorpusRequest(
        speakers=speakers,
        sentences=sentences,
        takes=takes,
        held_out_speakers=held_out_speakers,
        shared_passages=shared_passages,
        frame_rate=fps,
        seed=seed,
    )
    with progress("corpus", "take") as show:
        done = make_corpus(folder, request, processes=processes, show=show)
    kept = len(done.takes) - done.new_takes
    click.echo(
        f"Made {counted(done.new_takes, 'take')} in {folder}"
        + (f"; {kept} were there" if kept else "")
    )
    counts = {
        split: sum(take.split == split for take in done.takes)
        for split in ("train", "validation", "test")
    }
    click.echo(", ".join(f"{count} for {split}" for split, count in counts.items()))
