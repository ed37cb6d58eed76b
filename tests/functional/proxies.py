"""A study's real server behind a real proxy, both set up by the files that a server gets."""

import os
import shlex
import shutil
import signal
import socket
import ssl
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path, PurePosixPath
from urllib.request import urlopen

import httpx

from studyapp.custody.deployment import Deployment, Proxy, deployed_files
from studyapp.rehearsal.server import free_port

HOST = "study.example.org"
UNPACKED = Path(__file__).parents[2] / "build" / "proxies" / "usr"
"""Where `make setup-proxies` puts those that are not installed: without a service that runs."""

PATIENCE = 120
"""Seconds that a busy machine may take to start or end a server."""


def any_certificate() -> ssl.SSLContext:
    anything = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    anything.check_hostname = False
    anything.verify_mode = ssl.CERT_NONE
    return anything


class _ToThisMachine(httpx.HTTPTransport):
    """Reaches `HOST` at a port of this machine, with any certificate."""

    def __init__(self, port: int) -> None:
        super().__init__(verify=any_certificate())
        self.port = port

    def handle_request(self, request: httpx.Request) -> httpx.Response:
        forwarded = httpx.Request(
            request.method,
            request.url.copy_with(host="127.0.0.1", port=self.port),
            headers=request.headers,
            stream=request.stream,
            extensions={**request.extensions, "sni_hostname": HOST},
        )
        return super().handle_request(forwarded)


@dataclass(frozen=True)
class Proxied:
    """A study behind a proxy.

    Attributes
    ----------
    address : str
        Where participants find it.
    port : int
        Where the proxy listens on this machine.
    root : Path
        Holds everything that the proxy wrote.
    server : subprocess.Popen
        The study's server.
    """

    deployment: Deployment
    port: int
    root: Path
    server: subprocess.Popen[bytes]

    @property
    def address(self) -> str:
        return self.deployment.address

    def client(self) -> httpx.Client:
        return httpx.Client(transport=_ToThisMachine(self.port), trust_env=False, timeout=60)

    def written(self) -> str:
        """Return everything that the proxy has said or logged."""
        logs = [self.root / "proxy.log", *self.root.glob("var/log/**/*.log")]
        return "\n".join(log.read_text("utf-8", errors="replace") for log in logs)


def program(proxy: Proxy) -> str | None:
    """Return the path of `proxy`, if openssl is installed as well."""
    places = (os.environ["PATH"], UNPACKED / "bin", UNPACKED / "sbin")
    executable = shutil.which(proxy, path=os.pathsep.join(map(str, places)))
    return executable if shutil.which("openssl") else None


@contextmanager
def behind(proxy: Proxy, study: Path, root: Path, *, prefix: str) -> Iterator[Proxied]:
    """Serve `study` behind `proxy`, with `root` in place of the root of the server's disk."""
    deployment = Deployment(
        title="A study",
        folder=PurePosixPath(study),
        host=HOST,
        prefix=prefix,
        proxy=proxy,
        port=free_port(),
    )
    secure, plain = free_port(), free_port()
    placed = {file.place: file for file in deployed_files(deployment) if file.place}
    for place, file in placed.items():
        path = root / place.lstrip("/")
        path.parent.mkdir(parents=True, exist_ok=True)
        text = _at(file.text, root, secure, plain) if "etc/systemd" not in place else file.text
        path.write_text(text, "utf-8")
    with _study_server(deployment, root) as server:
        start = {"nginx": _nginx, "caddy": _caddy}[proxy]
        executable = str(program(proxy))
        secured = partial(_shake_hands, secure)
        with _running([executable, *start(root, secure, plain)], root / "proxy.log", secured):
            yield Proxied(deployment, secure, root, server)


def _at(text: str, root: Path, secure: int, plain: int) -> str:
    """Return a proxy's file with every path and port in a place that a test may use."""
    for place in ("/etc/caddy", "/etc/nginx/motionjury", "/etc/letsencrypt", "/var/log"):
        text = text.replace(f" {place}", f" {root}{place}")
    text = text.replace("listen [::]:", "# ")
    return text.replace("listen 443", f"listen 127.0.0.1:{secure}").replace(
        "listen 80;", f"listen 127.0.0.1:{plain};"
    )


@contextmanager
def _study_server(deployment: Deployment, root: Path) -> Iterator[subprocess.Popen[bytes]]:
    """Run the unit's command in the unit's environment."""
    unit = (root / f"etc/systemd/system/{deployment.unit}.service").read_text("utf-8")
    line = next(line for line in unit.splitlines() if line.startswith("ExecStart="))
    program, *arguments = shlex.split(line.removeprefix("ExecStart=").replace("%%", "%"))
    assert program == "/opt/motionjury/bin/motionjury"
    environment_file = (
        (root / f"etc/motionjury/{deployment.name}.env").read_text("utf-8").splitlines()
    )
    pairs = (line.split("=", 1) for line in environment_file if line and not line.startswith("#"))
    start = "from studyapp.cli.main import main; main()"
    command = [sys.executable, "-c", start, *arguments]
    environment = {**os.environ, **dict(pairs)}
    answers = partial(_ask, deployment.port)
    with _running(command, root / "study.log", answers, environment) as process:
        yield process


def _ask(port: int) -> None:
    urlopen(f"http://127.0.0.1:{port}/healthz", timeout=PATIENCE).close()


def _shake_hands(port: int) -> None:
    """Ask for the certificate, which Caddy may still be making when it already listens."""
    with (
        socket.create_connection(("127.0.0.1", port), timeout=1) as plain,
        any_certificate().wrap_socket(plain, server_hostname=HOST),
    ):
        pass


@contextmanager
def _running(
    command: list[str],
    log_file: Path,
    connect: Callable[[], None],
    environment: dict[str, str] | None = None,
) -> Iterator[subprocess.Popen[bytes]]:
    """Run `command` until the block ends; it begins when `connect` raises no `OSError`."""
    with log_file.open("wb") as log:
        process = subprocess.Popen(command, stdout=log, stderr=log, env=environment)
    try:
        deadline = time.monotonic() + PATIENCE
        while True:
            try:
                connect()
                break
            except OSError:
                assert process.poll() is None, log_file.read_text("utf-8")
                assert time.monotonic() < deadline, log_file.read_text("utf-8")
                time.sleep(0.05)
        yield process
    finally:
        process.send_signal(signal.SIGINT)  # all three then end at once
        process.wait(timeout=PATIENCE)


def _nginx(root: Path, _secure: int, _plain: int) -> list[str]:
    certificate = root / "etc/letsencrypt/live" / HOST
    certificate.mkdir(parents=True)
    made = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2"]
    made += ["-subj", f"/CN={HOST}", "-keyout", "privkey.pem", "-out", "fullchain.pem"]
    subprocess.run(made, cwd=certificate, check=True, capture_output=True)
    (root / "var/log/nginx").mkdir(parents=True)
    temporary_folders = "\n".join(
        f"    {kind}_temp_path {root}/{kind};"
        for kind in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
    )
    # Of Debian's own file, what matters here: it logs and packs wherever nobody says otherwise.
    (root / "nginx.conf").write_text(
        f"""
{"user root;" if os.getuid() == 0 else ""}
daemon off;
pid {root}/nginx.pid;
error_log {root}/var/log/nginx/general.log;
events {{ }}
http {{
    access_log {root}/var/log/nginx/access.log;
    sendfile on;
    gzip on;
{temporary_folders}
    include {root}/etc/nginx/conf.d/*.conf;
}}
""",
        "utf-8",
    )
    return ["-c", str(root / "nginx.conf"), "-e", str(root / "var/log/nginx/start.log")]


def _caddy(root: Path, secure: int, plain: int) -> list[str]:
    file = root / "etc/caddy/Caddyfile"
    # A test has no name on the internet for which certificates are given.
    ours = f"{{\n\tadmin off\n\tlocal_certs\n\tskip_install_trust\n\tstorage file_system {root}\n"
    ours += f"\thttp_port {plain}\n\thttps_port {secure}\n"
    file.write_text(file.read_text("utf-8").replace("{\n", ours, 1), "utf-8")
    return ["run", "--config", str(file), "--adapter", "caddyfile"]
