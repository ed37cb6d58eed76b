"""The report of what was played as a browser sends it."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from studyapp.session.videos.watch_evidence import MOST_INTERVALS, MOST_REPORTS, Playback

Second = Annotated[float, Field(ge=0, le=86_400, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=0, le=10_000_000, strict=True)]


class WatchReport(BaseModel):
    """One numbered report.

    Attributes
    ----------
    batch : int
        Counts the reports of a video from 0.
    intervals : tuple of (float, float)
        Played parts of the video, from and to, in seconds.

    The others are those of `studyapp.session.videos.watch_evidence.Playback`.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    batch: int = Field(ge=0, lt=MOST_REPORTS, strict=True)
    intervals: tuple[tuple[Second, Second], ...] = Field(max_length=MOST_INTERVALS)
    rate: float = Field(default=1.0, gt=0, le=100, allow_inf_nan=False)
    hidden_seconds: Second = 0.0
    silent_seconds: Second = 0.0
    stalls: Count = 0
    stalled_seconds: Second = 0.0
    frames: Count | None = None
    dropped_frames: Count | None = None

    @model_validator(mode="after")
    def _intervals_run_forward(self) -> Self:
        if any(start > end for start, end in self.intervals):
            raise ValueError("an interval ends before it begins")
        return self

    @property
    def playback(self) -> Playback:
        """How the intervals were played."""
        return Playback(**self.model_dump(exclude={"batch", "intervals"}))
