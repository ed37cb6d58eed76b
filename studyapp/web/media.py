"""The videos, under random names."""

from pathlib import Path
from typing import IO, Final, cast
from urllib.parse import quote

from flask import Blueprint, Response, abort, current_app, redirect, request
from werkzeug.exceptions import RequestedRangeNotSatisfiable
from werkzeug.wsgi import wrap_file

from motion.errors import InputError
from studyapp.session.playback import content_to_send, earlier_contents
from studyapp.study.design.trial import Content
from studyapp.web.media_store import KEPT_SECONDS as REDIRECT_SECONDS
from studyapp.web.site import study_site


class FilePart:
    """The bytes of `path` from `start` up to, not including, `stop`.

    A server that knows the number of bytes may let the kernel send them, from the descriptor's
    position on.
    """

    def __init__(self, path: Path, start: int, stop: int) -> None:
        self._file = path.open("rb", buffering=0)
        self._file.seek(start)
        self._left = stop - start

    def read(self, size: int = -1) -> bytes:
        """Return the next bytes, at most `size` of them where it is not negative."""
        count = self._left if size < 0 else min(size, self._left)
        block = self._file.read(count) or b""
        self._left -= len(block)
        return block

    def fileno(self) -> int:
        """Return the file's descriptor."""
        return self._file.fileno()

    def close(self) -> None:
        """Close the file."""
        self._file.close()


pages = Blueprint("media", __name__)

KEPT_SECONDS: Final = 3600
BLOCK: Final = 1 << 16

OWN_COPY: Final = "own"
"""Added by pages to the address of a video that the store does not send."""


@pages.get("/media/<token>.mp4")
def video(token: str) -> Response:
    """Send the video of a trial, whole or the requested byte range.

    The headers are the same for every file: name and age would tell videos apart.
    """
    site = study_site()
    content = content_to_send(site.database, token, site.clock, sent=request.method == "GET")
    video_file = site.served.videos.get(content) if content is not None else None
    if content is None or video_file is None:
        abort(404)
    site.record.require_unchanged()
    redirection = _redirect_to_store(token, content)
    if redirection is not None:
        return redirection
    response = send_video(video_file.file)
    response.headers["Cache-Control"] = f"private, max-age={KEPT_SECONDS}"
    return response


def _redirect_to_store(token: str, content: Content) -> Response | None:
    """Send the browser to the store for `content`; None if this server must send it.

    It must where a page asks for the server's own copy, because the store may be down.
    """
    site = study_site()
    if site.store is None or request.method != "GET" or OWN_COPY in request.args:
        return None
    try:
        address = site.store.address(content, earlier_contents(site.database, token))
    except InputError as error:
        # Such as expired keys. The file is on this server as well.
        current_app.logger.error("A video is sent from here: %s", error.what)
        return None
    if address is None:
        return None
    response = cast(Response, redirect(address, 302))
    response.headers["Cache-Control"] = f"private, max-age={REDIRECT_SECONDS}"
    return response


def send_video(file: Path) -> Response:
    """Send `file`, whole or the byte range that the present request asks for."""
    return _send_through_proxy(file) or _send(file)


def _send_through_proxy(file: Path) -> Response | None:
    """Name `file` to the proxy in front, which sends it in place of this response.

    None if there is no such proxy, or it cannot reach the file, such as a link out of the study.
    """
    site = study_site()
    if site.accel_prefix is None or not file.is_relative_to(site.folder):
        return None
    inner_path = quote(
        f"{site.accel_prefix.rstrip('/')}/{file.relative_to(site.folder).as_posix()}"
    )
    return Response(mimetype="video/mp4", headers={"X-Accel-Redirect": inner_path})


def _send(file: Path) -> Response:
    size = file.stat().st_size
    # Files have no version, so that no condition on one can hold.
    byte_range = None if "If-Range" in request.headers else request.range
    start, stop = 0, size
    headers = {"Accept-Ranges": "bytes"}
    if byte_range is not None:
        ends = byte_range.range_for_length(size)
        if ends is None or ends[1] is None:
            raise RequestedRangeNotSatisfiable(size)
        start, stop = ends[0], ends[1]
        headers["Content-Range"] = f"bytes {start}-{stop - 1}/{size}"
    headers["Content-Length"] = str(stop - start)
    return Response(
        # The server hands such a body to the kernel, which sends it without this process.
        wrap_file(request.environ, cast(IO[bytes], FilePart(file, start, stop)), BLOCK),
        206 if byte_range is not None else 200,
        headers,
        mimetype="video/mp4",
        direct_passthrough=True,
    )
