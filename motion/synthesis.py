"""Synthetic speech: sentences spoken by espeak-ng, with a prosody for each emotion.

It replaces recordings in demonstrations. It sounds synthetic, and its emotions are not acted.
"""

import shutil
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final
from xml.sax.saxutils import escape

from motion.audio import Audio, read_audio
from motion.errors import InputError
from motion.files import replacing

_PROGRAM: Final = "espeak-ng"


@dataclass(frozen=True, kw_only=True)
class SpokenProsody:
    """Prosody of synthetic speech.

    Attributes
    ----------
    speed : int
        Words per minute.
    pitch : int
        Height of the voice, 0 to 99; 50 is the voice's own.
    pitch_range : int
        Range of the pitch, in percent of the voice's own.
    amplitude : int
        Loudness, 0 to 200; 100 is the voice's own.
    """

    speed: int
    pitch: int
    pitch_range: int
    amplitude: int


PROSODY_OF_EMOTION: Final[Mapping[str, SpokenProsody]] = {
    "neutral": SpokenProsody(speed=150, pitch=45, pitch_range=100, amplitude=100),
    "happiness": SpokenProsody(speed=165, pitch=60, pitch_range=160, amplitude=115),
    "anger": SpokenProsody(speed=175, pitch=52, pitch_range=140, amplitude=125),
    "sadness": SpokenProsody(speed=120, pitch=34, pitch_range=50, amplitude=65),
    "contempt": SpokenProsody(speed=135, pitch=38, pitch_range=80, amplitude=85),
    "surprise": SpokenProsody(speed=160, pitch=66, pitch_range=190, amplitude=110),
    "fear": SpokenProsody(speed=185, pitch=70, pitch_range=60, amplitude=95),
    "disgust": SpokenProsody(speed=130, pitch=40, pitch_range=115, amplitude=100),
}
"""Anger, fear, happiness and sadness follow what Juslin & Laukka 2003 found across studies (anger,
fear and happiness fast, sadness slow and soft; anger and happiness with a wide pitch range, fear
and sadness with a narrow one); the other four were chosen to sound distinct."""


def speak(text: str, emotion: str, out_path: Path) -> Audio:
    """Speak `text` as `speak_as` does, with the prosody of one of `motion.segment.EMOTIONS`."""
    return speak_as(text, PROSODY_OF_EMOTION[emotion], out_path)


def speak_as(text: str, prosody: SpokenProsody, out_path: Path, speaker: str = "en") -> Audio:
    """Speak `text` into a WAV file.

    Parameters
    ----------
    text : str
        Plain text without markup.
    prosody : SpokenProsody
        Speed, pitch and loudness of the speech.
    out_path : Path
        The WAV file, written in one step.
    speaker : str
        espeak-ng's voice, such as ``en``, ``en-us`` or ``en+f3``.

    Returns
    -------
    Audio
        The speech, as `motion.audio.read_audio` reads it. The same arguments give the same
        samples.

    Raises
    ------
    InputError
        If espeak-ng is not installed or fails, or the voice is unknown.
    """
    program = _program()
    with replacing(Path(out_path)) as draft:
        _run(program, text, prosody, speaker, draft)
    return read_audio(Path(out_path))


def synthesiser_version() -> str:
    """Return the name and version of the synthesiser, on which the samples depend.

    Raises
    ------
    InputError
        If espeak-ng is not installed.
    """
    process = subprocess.run(  # noqa: S603
        [_program(), "--version"], capture_output=True, check=True, text=True
    )
    # The rest is the path of its data on this machine.
    return process.stdout.split("Data at")[0].strip()


def _program() -> str:
    program = shutil.which(_PROGRAM)
    if program is None:
        raise InputError(
            f"{_PROGRAM}, which speaks the sentences, is not installed",
            remedy="Install it with: sudo apt-get install espeak-ng",
        )
    return program


def _run(program: str, text: str, prosody: SpokenProsody, speaker: str, wav: Path) -> None:
    markup = f'<speak><prosody range="{prosody.pitch_range}%">{escape(text)}</prosody></speak>'
    command = [
        program,
        "--stdin",
        "-m",
        f"-v{speaker}",
        f"-s{prosody.speed}",
        f"-p{prosody.pitch}",
        f"-a{prosody.amplitude}",
        f"-w{wav}",
    ]
    try:
        # The command is a list of fixed options, and the text goes through standard input.
        subprocess.run(  # noqa: S603
            command, input=markup.encode(), capture_output=True, check=True
        )
    except subprocess.CalledProcessError as error:
        complaint = error.stderr.decode(errors="replace").strip().rstrip(".")
        raise InputError(
            f"{_PROGRAM} could not speak with voice {speaker!r}: {complaint}",
            remedy=f"Choose a voice from: {_PROGRAM} --voices",
        ) from error
