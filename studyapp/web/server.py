"""Serving a study to participants through gunicorn."""

import gc
import logging
import resource
import socket
import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any, Final

from flask import Flask
from gunicorn.app.base import BaseApplication  # type: ignore[import-untyped]
from sqlalchemy.exc import SQLAlchemyError

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database, database_url_of
from studyapp.monitoring.alarms import AlarmChannels, raise_alarms, watch_for_alarms
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import open_study
from studyapp.web.app import create_app
from studyapp.web.media_store import MediaStore
from studyapp.web.mounting import checked_prefix
from studyapp.web.site import believed_proxies, site_of
from studyapp.web.worker import StudyWorker

RETRY_SECONDS: Final = 1.0
"""Between a worker's attempts to start."""

WORKERS: Final = 2
THREADS: Final = 128
"""Requests that one worker answers side by side.

Slow connections cost no thread, see `studyapp.web.worker`; threads that wait for the database cost
next to nothing.
"""

CONNECTIONS: Final = 1000
"""Connections that one worker keeps open."""

DESCRIPTORS: Final = 4 * CONNECTIONS
"""Files that one worker may have open: connections, and the videos they read."""


class StudyServer(BaseApplication):  # type: ignore[misc]
    """gunicorn, configured in this process; every worker makes its own application."""

    def __init__(self, options: dict[str, Any], make: Callable[[], Flask]) -> None:
        self.options = options
        self.make = make
        super().__init__()

    def load_config(self) -> None:
        """Set the options; gunicorn reads no file and no command line."""
        for name, value in self.options.items():
            self.cfg.set(name, value)

    def load(self) -> Flask:
        """Make the application, in the worker's own process.

        A worker that gave up would stop the whole server, so this waits for a missing database.
        """
        while True:
            try:
                return self.make()
            except (InputError, SQLAlchemyError) as error:
                kind = type(error.__cause__ or error).__name__
                logging.getLogger("gunicorn.error").error("A worker waits to start (%s)", kind)
                time.sleep(RETRY_SECONDS)


def run_server(
    folder: Path,
    host: str,
    port: int,
    workers: int = WORKERS,
    *,
    accel_prefix: str | None = None,
    prefix: str = "",
    database_url: str | None = None,
    rehearsal_speed: float | None = None,
    new_version: bool = False,
    from_store: bool = False,
    origin: str = "",
    on_ready: Callable[[], None] | None = None,
) -> None:
    """Serve the study in `folder` until the process is told to stop (SIGINT or SIGTERM).

    Parameters
    ----------
    folder : Path
        The study folder.
    host, port : str, int
        Where to listen.
    workers : int
        Processes.
    database_url, rehearsal_speed, accel_prefix, prefix, origin
        See `studyapp.web.app.create_app`.
    new_version : bool
        Whether a design that has changed since participants came is served as a new version.
    from_store : bool
        Whether participants load the videos from the store to which they were published.
    on_ready : callable, optional
        Called when the server listens.

    Raises
    ------
    InputError
        Before anything is served: if the study or a video is missing, here or in the store, the
        address is taken, the database cannot be used, `prefix` is not a path,
        ``FORWARDED_ALLOW_IPS`` names no network, alarms cannot be sent as the study says, or the
        design has changed and `new_version` is not given.
    """
    prefix = checked_prefix(prefix)
    believed_proxies()
    rehearsal = rehearsal_speed is not None
    served = ServedStudy.read(folder).opened_for(rehearsal=rehearsal)
    store = MediaStore.of(folder, served) if from_store else None
    AlarmChannels.of(served.study)
    url = database_url or database_url_of(folder, rehearsal=rehearsal)

    def make() -> Flask:
        app = create_app(
            folder,
            database_url=url,
            rehearsal_speed=rehearsal_speed,
            accel_prefix=accel_prefix,
            prefix=prefix,
            served=served,
            store=store,
            origin=origin,
        )
        _watch_for_alarms(app)
        return app

    with listen(host, port) as listener:
        # Before the workers start, so that they need not all make schema and version at once.
        with closing(Database.open(url)) as database:
            open_study(database, served, Clock(), new_version=new_version)
        serve_application(make, listener, workers, on_ready=on_ready)


def serve_application(
    make: Callable[[], Flask],
    listener: socket.socket,
    workers: int,
    *,
    worker: type[StudyWorker] = StudyWorker,
    on_ready: Callable[[], None] | None,
) -> None:
    """Serve what `make` makes in each worker until the process is told to stop.

    Parameters
    ----------
    make : callable
        Called in each worker's own process.
    listener : socket
        See `listen`; gunicorn closes it.
    worker : type
        The kind of worker.
    workers, on_ready
        See `run_server`.
    """
    options = {
        "bind": f"fd://{listener.detach()}",
        "workers": workers,
        "worker_class": worker,
        "threads": THREADS,
        "worker_connections": CONNECTIONS,
        "preload_app": False,
        # Addresses hold participants' tokens.
        "accesslog": None,
        "loglevel": "warning",
        "proc_name": "motionjury",
        "control_socket_disable": True,
        # Of a proxy's headers, only the scheme is trusted here; `studyapp.web.site` reads the
        # client's address.
        "secure_scheme_headers": {"X-FORWARDED-PROTO": "https"},
        "forwarder_headers": "",
    }
    if on_ready is not None:
        options["when_ready"] = lambda _arbiter: on_ready()
    _allow_descriptors()
    # What is loaded by now is never freed. Workers share its memory as long as garbage collection
    # does not touch it.
    gc.freeze()
    StudyServer(options, make).run()


def _watch_for_alarms(app: Flask) -> None:
    """Send the alarms of the study of `app`, unless it is a rehearsal."""
    site = site_of(app)
    if site.clock.speed == 1.0 and (channels := AlarmChannels.of(site.study)).ways:
        watch_for_alarms(
            lambda: raise_alarms(site.database, site.served, site.clock, channels.send)
        )


def _allow_descriptors() -> None:
    """Let this process and its workers open as many files as they may need, if the system does."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    most = DESCRIPTORS if hard == resource.RLIM_INFINITY else min(DESCRIPTORS, hard)
    if soft != resource.RLIM_INFINITY and soft < most:
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, hard))


def listen(host: str, port: int) -> socket.socket:
    """Listen at `host` and `port`, where clients wait until the server is ready.

    Raises
    ------
    InputError
        If this machine cannot listen there.
    """
    is_v6 = ":" in host
    family = socket.AF_INET6 if is_v6 else socket.AF_INET
    try:
        return socket.create_server(
            (host.strip("[]"), port),
            family=family,
            backlog=2 * CONNECTIONS,
            dualstack_ipv6=is_v6 and socket.has_dualstack_ipv6(),
        )
    except OSError as error:
        raise InputError(
            # Python adds the address in parentheses.
            f"the server cannot listen there ({str(error.strerror).partition(' (')[0]})",
            where=f"{host}:{port}",
            remedy="Choose another --port or --host, or stop what listens there",
        ) from error
