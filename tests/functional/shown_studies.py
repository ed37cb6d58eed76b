"""Studies in which every page that a participant can come to occurs, to be looked at."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Final

import av
import numpy as np
from PIL import Image, ImageDraw

from tests.support.studies.asked_forms import CLOSING, CONSENT, DEMOGRAPHICS, ELIGIBILITY, SCALE
from tests.support.studies.finished_study import write_study_of_one_video
from tests.support.studies.redefining import redefine
from tests.support.studies.tiny_study import BACKGROUND, write_tiny_study

SIZE: Final = 360
FRAME_RATE: Final = 15
SAMPLE_RATE: Final = 48_000

PAGE: Final = """
[page]
organisation = "Institute of Gestures"
contact = "gestures@example.org"
minutes = 10
payment = "2.50 EUR"
consent = \"\"\"
You will watch short videos of an animated speaker and say what you think of them. We store your \
answers, when you gave them and how much of each video was played; nothing that names you.

Taking part is voluntary: you can stop at any time without giving a reason.\"\"\"
"""

S2UE_QUESTIONS: Final = """
[[questions]]
name = "naturalness"
title = "Naturalness"
text = "How natural does the motion look?"
labels = ["not natural at all", "hardly believable", "acceptable", "good", "very good"]

[[questions]]
name = "synchrony"
title = "Synchrony with the speech"
text = "How do face and body move with the speech?"
labels = [
  "hardly at all, or at random",
  "they move a little",
  "they move, but without expression",
  "they move with some expression",
  "they move with fitting expression",
]
"""

SLIDER_QUESTIONS: Final = """
[[questions]]
name = "quality"
title = "Quality"
text = "How human does the motion look?"
scale = "slider"

[[questions]]
name = "fit"
title = "Fit"
text = "How well does the motion fit the speech?"
scale = "slider"
reasons = [{ name = "hands", text = "the hands" }, { name = "face", text = "the face" }]
"""

OPINION_QUESTION: Final = """
[[questions]]
name = "quality"
title = "Quality"
text = "How good is the motion?"
scale = "mean_opinion"
reasons = [{ name = "hands", text = "the hands" }, { name = "face", text = "the face" }]
"""

DIFFSHEG_QUESTIONS: Final = """
[[questions]]
name = "realism"
title = "Realism"
text = "Which motion looks most like that of a real person?"

[[questions]]
name = "expression_synchrony"
title = "Expression and speech"
text = "In which video does the face fit the speech best?"

[[questions]]
name = "gesture_synchrony"
title = "Gestures and speech"
text = "In which video do the gestures fit the speech best?"

[[questions]]
name = "diversity"
title = "Diversity"
text = "Which motion is the most varied, as long as it stays smooth and natural?"
"""

FORMS: Final = f"""{ELIGIBILITY}{CONSENT}{DEMOGRAPHICS}{SCALE}
[[form.demographics]]
name = "gender"
text = "Which gender are you?"
choices = ["female", "male", "another", "I would rather not say"]

[[form.comprehension]]
name = "judged"
text = "What are you to judge?"
choices = ["how the speaker moves", "what the speaker looks like"]
eligible = ["how the speaker moves"]
{CLOSING}"""


def _conditions(count: int) -> str:
    names = ("first", "second", "third", "fourth", "fifth", "real")[:count]
    return "".join(f"[conditions.{name}]\nvideos = true\n" for name in names)


def _named(*names: str) -> str:
    return ", ".join(f'"{name}"' for name in names)


STUDIES: Final = {
    "players": f"""
name = "players"
title = "Gestures and speech"
protocol = "pairwise"
comparisons = "all_pairs"
layout = "players"
reference = "first"
participants = 50
trials = 2
practice = 1
catch = {{ trials = 0 }}
{_conditions(3)}
[[questions]]
name = "synchronisation"
title = "Synchronisation"
text = "In which video do the gestures fit the rhythm of the speech better?"
reasons = [{{ name = "hands", text = "the hands" }}, {{ name = "face", text = "the face" }}]

[[questions]]
name = "emotion"
title = "Emotion"
text = "In which video do the gestures show better what the speaker feels?"
{FORMS}{PAGE}
sound_check = true
break_every = 1
""",
    "labels": f"""
name = "labels"
title = "Motion and speech"
protocol = "rating"
participants = 50
{_conditions(4)}
[[sets]]
name = "all"
conditions = [{_named("first", "second", "third", "fourth")}]
groups = 1

[[sets]]
name = "fewer"
conditions = [{_named("first", "second", "third")}]
groups = 1
{S2UE_QUESTIONS}{PAGE}""",
    "sliders": f"""
name = "sliders"
title = "Motion and speech"
protocol = "rating"
participants = 50
attention = {{ trials = 1 }}
{_conditions(3)}
[[sets]]
name = "all"
conditions = [{_named("first", "second", "third")}]
groups = 1
{SLIDER_QUESTIONS}{PAGE}""",
    "opinion": f"""
name = "opinion"
title = "Motion and speech"
protocol = "rating"
participants = 50
{_conditions(3)}
[[sets]]
name = "all"
conditions = [{_named("first", "second", "third")}]
groups = 1
{OPINION_QUESTION}{PAGE}""",
    "ranking": f"""
name = "ranking"
title = "Motion and speech"
protocol = "ranking"
participants = 50
reference = "real"
{_conditions(6)}
[[blocks]]
name = "five"
conditions = [{_named("first", "second", "third", "fourth", "fifth")}]
trials = 1

[[blocks]]
name = "three"
conditions = [{_named("first", "second", "third")}]
trials = 1
{DIFFSHEG_QUESTIONS}{PAGE}""",
    "ties": f"""
name = "ties"
title = "Motion and speech"
protocol = "ranking"
participants = 50
ties = true
attention = {{ trials = 1 }}
{_conditions(4)}
[[blocks]]
name = "four"
conditions = [{_named("first", "second", "third", "fourth")}]
trials = 1
{DIFFSHEG_QUESTIONS}{PAGE}""",
    "mismatch": f"""
name = "mismatch"
title = "Motion and speech"
protocol = "mismatch"
participants = 50
fit = 1
realism = 1
{_conditions(3)}
[[questions]]
name = "better"
title = "Better"
text = "Which is better?"
{PAGE}""",
}
"""What the study files say; `composed` is written by `tests.support.studies.tiny_study`."""

NAMES: Final = ("composed", *STUDIES)


def write_shown_study(folder: Path, name: str, *, language: str = "en") -> None:
    """Write one of the studies `NAMES` into `folder`, ready to serve."""
    folder.mkdir(parents=True)
    if name == "composed":
        write_tiny_study(folder, seconds=1.0)
        redefine(folder, ("trials = 4", "trials = 1"))
    else:
        write_figure_video(folder / "figure.mp4")
        write_study_of_one_video(folder, STUDIES[name], folder / "figure.mp4")
    redefine(folder, ("[page]", f'[page]\nlanguage = "{language}"'))


def write_figure_video(path: Path, *, seconds: float = 1.0) -> None:
    """Write a square video of a figure that waves, on the background of rendered videos."""
    with av.open(path, "w", options={"movflags": "+faststart"}) as container:
        video = container.add_stream("libx264", rate=FRAME_RATE, options={"crf": "28"})
        video.width, video.height, video.pix_fmt = SIZE, SIZE, "yuv420p"
        audio = container.add_stream("aac", rate=SAMPLE_RATE, layout="mono")
        for index in range(int(seconds * FRAME_RATE)):
            frame = av.VideoFrame.from_ndarray(_figure(index), format="rgb24")
            container.mux(video.encode(frame))
        container.mux(video.encode(None))
        for start in range(0, int(seconds * SAMPLE_RATE), 1024):
            times = np.arange(start, min(start + 1024, int(seconds * SAMPLE_RATE))) / SAMPLE_RATE
            tone = (0.1 * np.sin(2 * np.pi * 220 * times)).astype(np.float32)
            sound = av.AudioFrame.from_ndarray(tone[None], format="fltp", layout="mono")
            sound.sample_rate, sound.pts = SAMPLE_RATE, start
            sound.time_base = Fraction(1, SAMPLE_RATE)
            container.mux(audio.encode(sound))
        container.mux(audio.encode(None))


def _figure(index: int) -> np.ndarray:
    picture = Image.new("RGB", (SIZE, SIZE), (BACKGROUND,) * 3)
    draw = ImageDraw.Draw(picture)
    swing = 40 * np.sin(index / 2)
    draw.ellipse((135, 50, 225, 150), fill=(196, 150, 122))
    draw.rounded_rectangle((115, 155, 245, 380), radius=30, fill=(70, 90, 130))
    draw.line((125, 180, 75, 260, 60 + swing, 200 - swing), fill=(70, 90, 130), width=30)
    draw.line((235, 180, 290, 265, 250 - swing, 290), fill=(70, 90, 130), width=30)
    return np.asarray(picture)
