"""Requests to a page that is served: its own address with its token, and no other."""

import pytest

from evenroad.viz.page_server import PageGuard

GUARD = PageGuard("127.0.0.1", "tok")
OWN = "http://127.0.0.1:8080"


@pytest.mark.parametrize(
    ("path", "host", "origin"),
    [
        ("/tok", "127.0.0.1:8080", None),
        ("/tok/", "127.0.0.1:8080", OWN),
        ("/tok?websocket=ws://127.0.0.1:8080/tok", "127.0.0.1:8080", None),
        ("/tok", "127.0.0.1", "http://127.0.0.1"),
        # Through a tunnel, as of ssh -L.
        ("/tok", "localhost:9000", "http://localhost:9000"),
    ],
)
def test_a_browser_at_the_address_is_let_in(path, host, origin):
    assert GUARD.refusal(path, [host], [origin] if origin else []) == ""


@pytest.mark.parametrize(
    ("path", "hosts", "origins"),
    [
        ("/", ["127.0.0.1:8080"], []),
        ("", ["127.0.0.1:8080"], []),
        ("/to", ["127.0.0.1:8080"], []),
        ("/tok2", ["127.0.0.1:8080"], []),
        ("/x/tok", ["127.0.0.1:8080"], []),
        ("/\u00e9", ["127.0.0.1:8080"], []),
        ("/tok", ["evil.example:8080"], []),
        ("/tok", ["127.0.0.1.evil.example:8080"], []),
        ("/tok", ["evil.example@127.0.0.1.x"], []),
        ("/tok", ["10.0.0.1:8080"], []),
        ("/tok", [""], []),
        ("/tok", [], []),
        ("/tok", ["127.0.0.1:8080", "evil.example"], []),
        ("/tok", ["127.0.0.1:8080"], ["http://evil.example"]),
        ("/tok", ["127.0.0.1:8080"], ["null"]),
        ("/tok", ["127.0.0.1:8080"], ["http://127.0.0.1:3000"]),
        ("/tok", ["127.0.0.1:8080"], ["https://127.0.0.1:8080"]),
        ("/tok", ["127.0.0.1:8080"], [OWN, "http://evil.example"]),
    ],
)
def test_all_others_are_refused_in_one_line_without_the_token(path, hosts, origins):
    why = GUARD.refusal(path, hosts, origins)
    assert why
    assert "\n" not in why
    assert "tok" not in why.replace("token", "")


def test_a_page_for_the_network_is_reached_by_addresses_and_by_no_foreign_name():
    everywhere = PageGuard("0.0.0.0", "tok")
    assert everywhere.refusal("/tok", ["192.168.1.5:8080"], ["http://192.168.1.5:8080"]) == ""
    assert everywhere.refusal("/tok", ["evil.example:8080"], [])


def test_tokens_differ():
    assert len({PageGuard.of("127.0.0.1").token for _ in range(100)}) == 100
