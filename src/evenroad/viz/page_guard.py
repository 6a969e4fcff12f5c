"""Who may use a page that is served: requests to its own address that know its token.

A page in the browser may move an arm's goal.  Any site that is open in the same browser can connect to it, as a name
that it owns may resolve to this computer (DNS rebinding), and WebSockets know no origin.
"""

from __future__ import annotations

import ipaddress
import secrets
import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from http import HTTPStatus
from threading import Lock
from typing import Any
from urllib.parse import urlsplit

from evenroad.errors import NotAvailable

_ONE_AT_A_TIME = Lock()


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

        Hosts and origins are the values of the headers of these names.  Browsers send an origin with every WebSocket;
        other programs need not.
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


@contextmanager
def guarded(guard: PageGuard) -> Iterator[None]:
    """Give the server that viser starts within this block a guard; raises NotAvailable where that fails.

    viser has no option for it.  Its server is one of `websockets`, which it calls by its name in that module.
    """
    from websockets.asyncio import server as websockets

    serve, began = websockets.serve, []

    def serve_guarded(*given: Any, process_request: Callable[..., Any] | None = None, **options: Any) -> Any:
        began.append(True)
        return serve(*given, process_request=_checked(process_request, guard), **options)

    with _ONE_AT_A_TIME:
        websockets.serve = serve_guarded
        try:
            yield
        finally:
            websockets.serve = serve
    if not began:
        raise NotAvailable("this version of viser serves pages in a way that cannot be guarded: evenroad view --html")


def _checked(answer: Callable[..., Any] | None, guard: PageGuard) -> Callable[..., Any]:
    """Return a handler that refuses what the guard does, and gives the rest on, without the token."""

    def checked(connection: Any, request: Any) -> Any:
        headers = request.headers
        why = guard.refusal(request.path, headers.get_all("Host"), headers.get_all("Origin"))
        if why:
            return connection.respond(HTTPStatus.FORBIDDEN, f"evenroad: {why}\n")
        path = request.path.removeprefix(f"/{guard.token}")
        return None if answer is None else answer(connection, replace(request, path=path or "/"))

    return checked
