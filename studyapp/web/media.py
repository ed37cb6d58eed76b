"""The videos, under names that say nothing."""

from __future__ import annotations

from typing import Final

from flask import Blueprint, abort, send_file
from flask.typing import ResponseReturnValue

from studyapp.services.taking_part import content_of
from studyapp.web.running import running

pages = Blueprint("media", __name__)

KEPT_SECONDS: Final = 3600


@pages.get("/media/<token>.mp4")
def video(token: str) -> ResponseReturnValue:
    """Send the video of a trial, whole or the byte range asked for.

    The headers are the same for every file: its name and age would tell videos apart.
    """
    here = running()
    content = content_of(here.database, token)
    found = here.served.videos.get(content) if content is not None else None
    if found is None:
        abort(404)
    response = send_file(
        found.file,
        mimetype="video/mp4",
        download_name="video.mp4",
        conditional=True,
        etag=False,
        # When the file was made could be found out by asking for what is newer than a date.
        last_modified=0,
    )
    for name in ("Last-Modified", "Content-Disposition", "Expires"):
        response.headers.pop(name, None)
    response.headers["Cache-Control"] = f"private, max-age={KEPT_SECONDS}"
    return response
