"""Opening a page in a browser, and what to do where none opens, as over SSH."""

from __future__ import annotations

import os
import sys
import webbrowser
from urllib.parse import urlsplit


def open_browser(address: str) -> bool:
    """Open an address in a browser of this computer's desktop, and return whether there was one.

    Without a desktop nothing opens: a browser in the terminal would take the terminal.
    """
    if not _has_desktop():
        return False
    try:
        return webbrowser.open(address)
    except (webbrowser.Error, OSError):
        return False


def how_to_open(address: str, is_open: bool) -> str:
    """Return the line that says where a page is served, with another where no browser opened it."""
    said = f"{address}   (Ctrl-C ends it)"
    if is_open:
        return said
    port = urlsplit(address).port
    return (
        f"{said}\nno browser opens here; on yours open that address after: ssh -L {port}:127.0.0.1:{port} THIS-COMPUTER"
    )


def _has_desktop() -> bool:
    """Return whether this computer has a desktop in front of the user."""
    if os.environ.get("BROWSER"):
        return True
    if sys.platform in ("win32", "darwin"):
        return "SSH_CONNECTION" not in os.environ
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
