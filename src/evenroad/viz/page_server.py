"""A page that this computer serves, and who may use it: requests to its own address that know its token.

A page in the browser may move an arm's goal.  Any site that is open in the same browser can send requests to it, and a
name that the site owns may resolve to this computer (DNS rebinding).
"""

from __future__ import annotations

import ipaddress
import secrets
import socket
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler
from socketserver import ThreadingTCPServer
from threading import Thread
from urllib.parse import urlsplit

from evenroad.errors import NotAvailable

LONGEST = 100_000
"""Largest size of what a browser sends [bytes]."""


@dataclass(frozen=True)
class PageGuard:
    """Address of a page: the host that it is served at, and the token that its path begins with."""

    host: str
    token: str

    @classmethod
    def of(cls, host: str) -> PageGuard:
        """Return the guard of a new page, with a token of its own."""
        return cls(host, secrets.token_urlsafe(16))

    def refusal(self, path: str, hosts: list[str], origins: list[str]) -> str:
        """Return why a request is refused, in one line, or "".

        Hosts and origins are the values of the headers of these names.  Browsers send an origin with every request that
        changes something; other programs need not.
        """
        first = path.partition("?")[0].split("/")[1:2]
        if not first or not secrets.compare_digest(first[0].encode(), self.token.encode()):
            return "the address has no token, or a wrong one: open the one that was printed"
        name = urlsplit(f"//{hosts[0]}").hostname if len(hosts) == 1 else None
        if name is None or not self._is_here(name):
            return f"this page is served at {self.host} alone"
        if any(origin.lower() != f"http://{hosts[0]}".lower() for origin in origins):
            return "another page may not use this one"
        return ""

    def _is_here(self, name: str) -> bool:
        """Return whether a name is that of the computer that serves: no name that others own can be."""
        try:
            address = ipaddress.ip_address(name)
        except ValueError:
            return name in ("localhost", self.host.lower(), socket.gethostname().lower())
        # A page for all addresses of this computer is reached by any of them.
        everywhere = self.host in ("", "0.0.0.0", "::")
        return name == self.host or everywhere or (address.is_loopback and self.host == "localhost")


class PageServer(ThreadingTCPServer):
    """A page served at an address: `page` returns its text, and `change` the answer to what the browser sends.

    A page that only plays answers nothing.

    Raises NotAvailable if the port is taken.
    """

    allow_reuse_address = True
    daemon_threads = True

    def __init__(
        self, host: str, port: int, page: Callable[[], str], change: Callable[[bytes], bytes | None] = lambda _: None
    ) -> None:
        self.guard, self.page, self.change = PageGuard.of(host), page, change
        try:
            super().__init__((host, port), _Handler)
        except OSError as error:
            free = "port 0 takes any that is free"
            raise NotAvailable(f"no page can be served at {host}, port {port}: {error}; {free}") from None
        Thread(target=self.serve_forever, daemon=True).start()

    @property
    def address(self) -> str:
        """Address of the page, for a browser; its token lets nobody else in."""
        return f"http://{self.guard.host}:{self.server_address[1]}/{self.guard.token}"

    def serve(self) -> None:
        """Serve until Ctrl-C."""
        while True:
            time.sleep(1.0)

    def close(self) -> None:
        """Stop serving."""
        self.shutdown()
        self.server_close()

    def handle_error(self, request: object, client_address: object) -> None:
        """Report an error, but not a browser that went away."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)  # type: ignore[arg-type]


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    timeout = 60.0
    server: PageServer

    def do_GET(self) -> None:
        if self._is_let_in():
            self._answer(HTTPStatus.OK, "text/html", self.server.page().encode())

    def do_POST(self) -> None:
        if not self._is_let_in():
            return
        length = self.headers.get("Content-Length", "")
        if not length.isdecimal() or int(length) > LONGEST:
            self._refuse(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, "too much at once")
            return
        answer = self.server.change(self.rfile.read(int(length)))
        if answer is None:
            self._refuse(HTTPStatus.BAD_REQUEST, "no change that this page knows")
        else:
            self._answer(HTTPStatus.OK, "application/json", answer)

    def log_message(self, format: str, *args: object) -> None:
        """Print nothing."""

    def _is_let_in(self) -> bool:
        guard, (hosts, origins) = self.server.guard, (self.headers.get_all(each, []) for each in ("Host", "Origin"))
        why = guard.refusal(self.path, hosts, origins)
        if why:
            self._refuse(HTTPStatus.FORBIDDEN, why)
        elif self.path.partition("?")[0].rstrip("/") != f"/{guard.token}":
            self._refuse(HTTPStatus.NOT_FOUND, "this page is all that there is")
            return False
        return not why

    def _refuse(self, status: HTTPStatus, why: str) -> None:
        # The rest of the request is not read, so the connection cannot serve another one.
        self.close_connection = True
        self._answer(status, "text/plain", f"evenroad: {why}\n".encode())

    def _answer(self, status: HTTPStatus, kind: str, content: bytes) -> None:
        self.send_response(status)
        headers = {"Content-Type": f"{kind}; charset=utf-8", "Content-Length": str(len(content))}
        headers |= {"Cache-Control": "no-store", "Referrer-Policy": "no-referrer"}
        for name, value in headers.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(content)
