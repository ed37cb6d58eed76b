"""Headers that keep a page's address, content and origin to itself."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from flask import Flask, Response, request

from studyapp.session.departure import MTURK_FRAMES, MTURK_SITES
from studyapp.study.settings.recruitment import Recruitment

PROTECTION: Final = {
    # The address of a page holds the participant's token.
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Robots-Tag": "noindex",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}


PARTICIPANTS: Final = ("entrance", "participant", "sound_check", "withdrawal")
"""Blueprints of the pages that a recruiter may show in a frame."""


def protect(app: Flask, *, recruitment: Recruitment, media: str = "") -> None:
    """Add the headers to every answer of `app`.

    Pages can be shown within those of others only where a recruiter needs it; those of
    researchers never.

    Parameters
    ----------
    media : str
        The origin of the store that participants load videos from; empty where there is none.
    """
    alone = _policy() | {"X-Frame-Options": "DENY"}
    framed = _policy(media=media) | {"X-Frame-Options": "DENY"}
    if recruitment.channel == "mturk":
        # X-Frame-Options cannot name several sites: 'frame-ancestors' does, and stands alone.
        framed = _policy(frames=MTURK_FRAMES, forms=MTURK_SITES, media=media)

    @app.after_request
    def add_headers(response: Response) -> Response:
        response.headers.update(PROTECTION)
        response.headers.update(framed if request.blueprint in PARTICIPANTS else alone)
        if request.endpoint not in ("static", "media.video"):
            response.headers["Cache-Control"] = "no-store"
            response.headers.pop("Expires", None)
        return response


def _policy(
    *, frames: Sequence[str] = (), forms: Sequence[str] = (), media: str = ""
) -> dict[str, str]:
    """Return the policy of pages that `frames` may hold, and whose forms may go to `forms`.

    Their videos may come from `media` too, played or fetched ahead.
    """
    rules = (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "img-src 'self'",
        f"media-src 'self' {media}".rstrip(),
        f"connect-src 'self' {media}".rstrip(),
        " ".join(("form-action 'self'", *forms)),
        "base-uri 'none'",
        " ".join(("frame-ancestors", *(frames or ("'none'",)))),
    )
    return {"Content-Security-Policy": "; ".join(rules)}
