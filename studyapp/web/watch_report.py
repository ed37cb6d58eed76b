"""The report of played intervals as a browser sends it."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Second = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class WatchReport(BaseModel):
    """One numbered report.

    Attributes
    ----------
    batch : int
        Counts the reports of a trial from 0.
    intervals : tuple of (float, float)
        Played parts of the video, from and to, in seconds.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    batch: int = Field(ge=0, le=9999, strict=True)
    intervals: tuple[tuple[Second, Second], ...] = Field(max_length=200)
