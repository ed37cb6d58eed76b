"""A strip: rows of conditions, columns of moments and their words, over the speech's time axis."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Self

import numpy as np
from PIL import Image
from scipy.ndimage import gaussian_filter1d
from scipy.signal import find_peaks

from motion.audio import Audio
from motion.errors import InputError
from renderer.figures.plate import (
    DOTS_PER_INCH,
    FAINT_INK,
    LETTERS,
    Plate,
    fitted,
    font,
    pixels,
)

MAX_MOMENTS: Final = 16
"""Largest number of moments that is legible in one figure."""

_STEP: Final = 0.01
_SYLLABLE: Final = 0.06
"""Seconds over which loudness is averaged, about half a syllable."""

_SMALLEST_LETTERS: Final = 4.5
_TEXT_SHARE: Final = 0.93  # share of a panel's side that text may fill
_CUT_SHARE: Final = 0.97  # a little more, as sizes of letters are rounded
_GAP: Final = 6  # pixels between panels
_LINE: Final = 1.5  # height of a line of text, in letters
_WAVE_HEIGHT: Final = 0.34  # inches
_FAN_HEIGHT: Final = 0.16  # inches between the panels and the wave
_WAVE_COLUMNS: Final = 600


@dataclass(frozen=True, kw_only=True)
class Moment:
    """One moment of a segment.

    Attributes
    ----------
    seconds : float
        Time from the segment's start.
    word : str
        The key word spoken at that time; empty if none was given.
    """

    seconds: float
    word: str = ""

    @classmethod
    def parse(cls, text: str) -> Self:
        """Parse ``2.4``, or ``word=2.4`` with the key word spoken at that time."""
        word, _, number = text.rpartition("=")
        try:
            return cls(seconds=float(number), word=word.strip())
        except ValueError:
            raise InputError(
                f"{text!r} is not a moment", remedy="Give seconds such as 2.4, or 'word=2.4'"
            ) from None

    @property
    def label(self) -> str:
        """The key word, or the time if there is none."""
        return self.word or f"{self.seconds:.1f} s"


def even_moments(duration: float, count: int) -> tuple[Moment, ...]:
    """Return `count` moments evenly spaced over `duration` seconds, away from both ends."""
    return tuple(
        Moment(seconds=round(duration * (place + 0.5) / count, 3)) for place in range(count)
    )


def loud_moments(speech: Audio, count: int) -> tuple[Moment, ...]:
    """Return the loudest syllable in each of `count` equal parts of `speech`, in order.

    Gestures coincide with stressed syllables, which are loud; one from each part covers the whole
    speech. They are at least half a part apart, so that no syllable is shown twice. A part without
    a syllable gives its middle.
    """
    step = max(1, round(_STEP * speech.sample_rate))
    length = len(speech.samples) // step * step
    if length < count * step:
        return even_moments(speech.duration, count)
    energy = np.square(speech.samples[:length], dtype=np.float64).reshape(-1, step).mean(axis=1)
    loudness = gaussian_filter1d(energy, _SYLLABLE / _STEP)
    syllables, _ = find_peaks(loudness, distance=math.ceil(len(loudness) / count / 2))
    moments = []
    for part in np.array_split(np.arange(len(loudness)), count):
        peaks = syllables[(syllables >= part[0]) & (syllables <= part[-1])]
        loudest = peaks[np.argmax(loudness[peaks])] if len(peaks) else part[len(part) // 2]
        moments.append(Moment(seconds=round(float(loudest) * _STEP, 3)))
    return tuple(moments)


@dataclass(frozen=True, kw_only=True)
class StripLayout:
    """The layout of a strip.

    Attributes
    ----------
    inches : float
        Width of the page.
    rows : tuple of str
        Names of the conditions, from top to bottom.
    moments : tuple of Moment
        The moments, from left to right; at least one.
    aspect : float
        Height of a panel divided by its width.
    wave : bool
        Whether the speech's waveform is drawn under the panels.
    """

    inches: float
    rows: tuple[str, ...]
    moments: tuple[Moment, ...]
    aspect: float
    wave: bool = True

    @property
    def margin(self) -> int:
        """Pixels on the left for the names, which are written vertically."""
        return round(pixels(LETTERS) * _LINE) + _GAP

    @property
    def panel(self) -> tuple[int, int]:
        """Width and height of a panel in pixels."""
        count = len(self.moments)
        room = round(self.inches * DOTS_PER_INCH) - self.margin - _GAP * (count - 1)
        return room // count, round(room // count * self.aspect)


def draw_strip(
    layout: StripLayout,
    panels: Mapping[tuple[str, Moment], Image.Image],
    speech: Audio,
    *,
    clear: bool,
) -> Plate:
    """Return the strip as a page.

    Parameters
    ----------
    layout : StripLayout
        The layout.
    panels : mapping of (row, moment) to Image
        The pictures, each as large as ``layout.panel``.
    speech : Audio
        The speech of the segment.
    clear : bool
        Whether the page has no background.
    """
    width, height = layout.panel
    line = pixels(LETTERS) * _LINE
    panels_height = len(layout.rows) * (height + _GAP) - _GAP
    words_at = panels_height + line
    axis_at = words_at + _FAN_HEIGHT * DOTS_PER_INCH
    wave = round(_WAVE_HEIGHT * DOTS_PER_INCH) if layout.wave else round(line / 4)
    page = Plate.of(
        layout.margin + len(layout.moments) * (width + _GAP) - _GAP,
        round(axis_at + wave + 1.4 * line),
        clear=clear,
    )
    texts, names_size = _fit_texts(layout.rows, height)
    for row, name in enumerate(layout.rows):
        top = row * (height + _GAP)
        middle = top + height / 2
        page.write(line / 2, middle, texts[row], rotation=90, ha="center", fontsize=names_size)
        for column, moment in enumerate(layout.moments):
            left = layout.margin + column * (width + _GAP)
            page.add_picture(panels[name, moment], left, top)
    centres = [
        layout.margin + column * (width + _GAP) + width / 2 for column in range(len(layout.moments))
    ]
    words = [f"“{moment.word}”" if moment.word else moment.label for moment in layout.moments]
    texts, words_size = _fit_texts(words, width)
    for centre, moment, word in zip(centres, layout.moments, texts, strict=True):
        style = "italic" if moment.word else "normal"
        words_middle = panels_height + line * 0.55
        page.write(centre, words_middle, word, ha="center", fontsize=words_size, fontstyle=style)
    _draw_time(page, layout, speech, centres, words_at, axis_at, wave)
    return page


def _fit_texts(texts: Sequence[str], room: float) -> tuple[list[str], float]:
    """Return `texts`, shortened if necessary, and the font size at which all fit `room` pixels."""
    longest = max(font(pixels(LETTERS)).getlength(text) for text in texts)
    size = min(LETTERS, max(_SMALLEST_LETTERS, LETTERS * _TEXT_SHARE * room / longest))
    return [fitted(text, font(pixels(size)), _CUT_SHARE * room) for text in texts], size


def _draw_time(
    page: Plate,
    layout: StripLayout,
    speech: Audio,
    centres: Sequence[float],
    words_at: float,
    axis_at: float,
    wave: float,
) -> None:
    """Draw the time axis, the wave on it, and a line from each column to its moment."""
    from matplotlib.ticker import MaxNLocator

    room = page.width - layout.margin
    axes = page.area(layout.margin, words_at, room, axis_at + wave - words_at)
    axes.set_xlim(0, speech.duration)
    axes.set_ylim(axis_at + wave, words_at)
    if layout.wave:
        loud = _envelope(speech.samples) * wave / 2
        times = np.linspace(0, speech.duration, len(loud))
        middle = axis_at + wave / 2
        axes.fill_between(times, middle - loud, middle + loud, color="#9aa0a6", linewidth=0)
    for centre, moment in zip(centres, layout.moments, strict=True):
        at = (centre - layout.margin) / room * speech.duration
        axes.plot(
            [at, moment.seconds, moment.seconds],
            [words_at, axis_at, axis_at + wave],
            color="#0072B2",
            linewidth=0.6,
            clip_on=False,
        )
    axes.set_axis_on()
    axes.spines[["left", "top", "right"]].set_visible(False)
    axes.yaxis.set_visible(False)
    # A label at the right end would leave the page.
    count = min(10, int(room / pixels(3 * LETTERS)))
    axes.xaxis.set_major_locator(MaxNLocator(count, prune="upper"))
    axes.xaxis.set_major_formatter("{x:g} s")
    axes.tick_params(labelsize=LETTERS - 2, labelcolor=FAINT_INK, pad=2)


def _envelope(samples: np.ndarray) -> np.ndarray:
    """Return the largest amplitude in each of `_WAVE_COLUMNS` parts, scaled to at most 1."""
    parts = np.array_split(np.abs(samples), min(_WAVE_COLUMNS, len(samples)))
    peaks = np.array([part.max() for part in parts])
    return peaks / max(float(peaks.max()), 1e-9)
