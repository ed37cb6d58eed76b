"""A private PostgreSQL server in a temporary folder, for tests, the benchmark and the soak."""

import os
import pwd
import secrets
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final, LiteralString

import psycopg
from psycopg import sql
from sqlalchemy import URL

from motion.errors import InputError

SUPERUSER: Final = "motionjury"
START_SECONDS: Final = 60
"""How long a server may take to accept connections; after a crash it first recovers."""

GO_TOGETHER: Final = """
cat > /dev/null
running=$1/data/postmaster.pid
if read -r server < "$running" && kill -QUIT "$server"; then
    for _ in 1 2 3 4 5 6 7 8 9; do
        [ -e "$running" ] && sleep 0.2
    done
fi
rm -rf "$1"
"""
"""What ends the server when the process that started it was killed: its end of the pipe closes."""


def programs() -> Path | None:
    """Return the folder of PostgreSQL's server programs, None where it is not installed."""
    packaged = sorted(
        Path("/usr/lib/postgresql").glob("*/bin/postgres"), key=lambda path: int(path.parts[-3])
    )
    program = packaged[-1] if packaged else shutil.which("postgres")
    return None if program is None else Path(program).parent


class ThrowawayPostgresql:
    """A running server that only this user's processes on this machine reach.

    It listens on a socket in its own folder and asks for a password drawn for it.

    Attributes
    ----------
    url : str
        Address of an empty database, for SQLAlchemy with psycopg.
    folder : Path
        Contains all files of the server.
    process : Popen
        The server; its `pid` is that of the process that starts all others.
    """

    def __init__(self, binaries: Path, folder: Path, *, durable: bool) -> None:
        self._binaries, self.folder, self._durable = binaries, folder, durable
        self._password = secrets.token_urlsafe()
        self._owner = _owner()
        if self._owner:
            shutil.chown(folder, self._owner["user"], self._owner["group"])
        self._make()
        self.process = self._launch()
        self._await_connections(tries_again=False)
        self.url = self.create_database("motionjury")

    def create_database(self, name: str, *, template: str = "template0") -> str:
        """Make a database, empty or as a copy of another one, and return its address."""
        self._execute("CREATE DATABASE {} TEMPLATE {}", name, template)
        address = URL.create(
            "postgresql+psycopg",
            SUPERUSER,
            self._password,
            database=name,
            query={"host": str(self.folder)},
        )
        return address.render_as_string(hide_password=False)

    def drop_database(self, name: str) -> None:
        """Remove a database, whoever is connected to it."""
        self._execute("DROP DATABASE {} WITH (FORCE)", name)

    def kill(self) -> None:
        """Kill the server as a crash does (SIGKILL); `start` brings it back."""
        self.process.kill()
        self.process.wait()

    def start(self) -> None:
        """Start the server again after `kill`; it recovers what was committed."""
        self.process = self._launch()
        # The old server's processes may need a moment to notice that it is gone.
        self._await_connections(tries_again=True)

    def stop(self) -> None:
        """End the server at once, without tidying up."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGQUIT)
        try:
            self.process.wait(timeout=START_SECONDS)
        except subprocess.TimeoutExpired:
            self.kill()

    def _make(self) -> None:
        password = self.folder / "password"
        password.write_text(self._password, encoding="utf-8")
        if self._owner:
            shutil.chown(password, self._owner["user"])
        made = subprocess.run(
            [
                self._binaries / "initdb",
                f"--pgdata={self.folder / 'data'}",
                f"--username={SUPERUSER}",
                f"--pwfile={password}",
                "--auth=scram-sha-256",
                "--encoding=UTF8",
                "--locale=C",
                "--no-sync",
            ],
            cwd=self.folder,
            capture_output=True,
            text=True,
            check=False,
            **self._owner,
        )
        password.unlink()
        if made.returncode != 0:
            raise self._failure(made.stderr)

    def _launch(self) -> subprocess.Popen[bytes]:
        settings = {
            "listen_addresses": "",
            "unix_socket_directories": str(self.folder),
            "max_connections": "300",
        }
        if not self._durable:
            settings |= {"fsync": "off", "synchronous_commit": "off", "full_page_writes": "off"}
        with (self.folder / "log").open("ab") as log:
            return subprocess.Popen(
                [
                    self._binaries / "postgres",
                    "-D",
                    self.folder / "data",
                    *(f"--{name}={value}" for name, value in settings.items()),
                ],
                cwd=self.folder,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                # Ctrl-C is for the program that uses the server; that one then ends it.
                start_new_session=True,
                **self._owner,
            )

    def _await_connections(self, *, tries_again: bool) -> None:
        """Wait until the server answers; one that ends instead may be started again."""
        end = time.monotonic() + START_SECONDS
        while True:
            try:
                self._connect().close()
                return
            except psycopg.OperationalError:
                ended = self.process.poll() is not None
                if time.monotonic() > end or (ended and not tries_again):
                    self.stop()
                    log = (self.folder / "log").read_text("utf-8", errors="replace")
                    raise self._failure(log) from None
            if ended:
                self.process = self._launch()
            time.sleep(0.05)

    def _connect(self) -> psycopg.Connection[Any]:
        return psycopg.connect(
            host=str(self.folder),
            user=SUPERUSER,
            password=self._password,
            dbname="postgres",
            autocommit=True,
        )

    def _execute(self, statement: LiteralString, *names: str) -> None:
        with self._connect() as connection:
            connection.execute(sql.SQL(statement).format(*map(sql.Identifier, names)))

    def _failure(self, output: str) -> InputError:
        return InputError(
            f"PostgreSQL does not start: {output[-2000:].strip()}",
            where=str(self.folder),
            remedy="Read what PostgreSQL says, and fix that",
        )


@contextmanager
def throwaway_postgresql(*, durable: bool = True) -> Iterator[ThrowawayPostgresql]:
    """Start a PostgreSQL server, and end and remove it afterwards, whatever happens.

    Parameters
    ----------
    durable : bool
        Whether a commit waits for the disk. Without, tests that claim nothing about crashes are
        several times as fast.

    Raises
    ------
    InputError
        If PostgreSQL is not installed or does not start.
    """
    binaries = programs()
    if binaries is None:
        raise InputError(
            "PostgreSQL is not installed on this machine",
            where="/usr/lib/postgresql",
            remedy="Install Debian's package: apt-get install postgresql",
        )
    folder = Path(tempfile.mkdtemp(prefix="postgresql-"))
    warden = subprocess.Popen(
        ["/bin/sh", "-c", GO_TOGETHER, "sh", str(folder)],
        stdin=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    server = None
    try:
        server = ThrowawayPostgresql(binaries, folder, durable=durable)
        yield server
    finally:
        if server is not None:
            server.stop()
        # The warden removes the folder.
        warden.communicate()


def _owner() -> dict[str, Any]:
    """Return how to start a process as a user other than root, whom PostgreSQL refuses."""
    if os.geteuid() != 0:
        return {}
    names = {entry.pw_name: entry.pw_gid for entry in pwd.getpwall()}
    name = "postgres" if "postgres" in names else "nobody"
    return {"user": name, "group": names[name], "extra_groups": ()}
