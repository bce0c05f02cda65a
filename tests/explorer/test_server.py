"""The protocol of the page's server, without a browser: what it answers, and what it refuses."""

import http.client
import re
import socket
import time
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.explorer.conftest import RETURNS, Client

from whirlmap.explorer.encoding import decoded
from whirlmap.explorer.exploration import Exploration
from whirlmap.explorer.finer import compute
from whirlmap.explorer.jobs import Job


def test_the_page_needs_nothing_else(client: Client) -> None:
    status, html, headers = client.ask("")
    assert status == 200
    nonce = re.search(r"'nonce-([^']+)'", headers["Content-Security-Policy"])
    assert nonce is not None
    assert "default-src 'none'" in headers["Content-Security-Policy"]
    assert html.count("<script") == html.count(f'<script nonce="{nonce[1]}"') > 5
    assert not re.search(r"""(?:src|href)=["'](?!data:)""", html)
    assert "http://" not in html.replace("http://www.w3.org", "")
    assert client.ask("")[2]["Content-Security-Policy"] != headers["Content-Security-Policy"]


def test_data_hold_the_diagram(client: Client) -> None:
    status, data, _ = client.ask("data")
    assert status == 200
    assert data["kind"] == "diagram"
    assert decoded(data["overview"]["axes"][0]["values"]).tolist() == [0.2, 0.24, 0.28, 0.285, 0.29]
    assert decoded(data["overview"]["period"]).tolist() == [1, 1, 2, 2, 4]
    assert decoded(data["overview"]["section"][""]["x"]).shape[0] == 5
    assert data["controls"][0]["name"] == "gamma"


def test_a_motion_and_another_quantity_of_it(client: Client) -> None:
    for gamma, period in RETURNS.items():
        status, m, _ = client.ask("motion", {"values": {"gamma": gamma}, "quantity": "v"})
        assert status == 200
        assert m["label"]["period"] == period
        assert m["spectrum"]["quantity"] == "v"
    again, new = [], []
    for k in range(3):  # the shortest of three, on a machine that does other work too
        begun = time.perf_counter()
        client.ask("motion", {"values": {"gamma": 0.29}, "quantity": "x"})
        again.append(time.perf_counter() - begun)
        begun = time.perf_counter()
        client.ask("motion", {"values": {"gamma": 0.2901 + 1e-4 * k}, "quantity": "x"})
        new.append(time.perf_counter() - begun)
    assert min(again) < min(new)


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Host": "evil.example"}, 421), ({"Host": "127.0.0.1"}, 421), ({"Host": "127.0.0.1.evil.example:80"}, 421),
        ({"Origin": "http://evil.example"}, 403), ({"Origin": "null"}, 403), ({"Sec-Fetch-Site": "cross-site"}, 403),
    ],
)  # fmt: skip
def test_other_hosts_and_origins_are_refused(client: Client, headers: dict[str, str], status: int) -> None:
    for name, body in (("", None), ("data", None), ("motion", {})):
        assert client.ask(name, body, headers=headers)[0] == status


def test_its_own_origin_is_not(client: Client) -> None:
    origin = {"Origin": f"http://127.0.0.1:{client.server.port}"}
    assert client.ask("state", headers=origin)[0] == 200
    local = {"Host": f"localhost:{client.server.port}", "Origin": f"http://localhost:{client.server.port}"}
    assert client.ask("state", headers=local)[0] == 200


@pytest.mark.parametrize("path", [
    "/", "/etc/passwd", "/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/data", "//", "/{token}", "/{token}/../data",
    "/{token}/..%2f..%2fetc/passwd", "/{token}/page/explorer.js", "/{token}/data/", "/{token}/data?x=1",
    "/{token}/__class__", "/{token}/session", "/{token}x/data", "/{short}/data", "/é/data",
])  # fmt: skip
def test_nothing_lies_elsewhere(client: Client, path: str) -> None:
    token = client.server.token
    whole = path.format(token=token, short=token[:-1]).encode().decode("latin-1")
    with socket.create_connection(("127.0.0.1", client.server.port), timeout=20) as connection:
        text = f"GET {whole} HTTP/1.1\r\nHost: 127.0.0.1:{client.server.port}\r\nConnection: close\r\n\r\n"
        connection.sendall(text.encode("latin-1"))
        answer = http.client.HTTPResponse(connection)
        answer.begin()
        assert answer.status == 404
        assert b"root:" not in answer.read()


@pytest.mark.parametrize(
    ("name", "body", "status"),
    [
        ("motion", {"values": {"gamm": 0.2}}, 422), ("motion", {"values": {"gamma": "0.2"}}, 422),
        ("motion", {"values": {"gamma": 1e31}}, 422), ("motion", {"values": {"gamma": True}}, 422),
        ("motion", {"values": {"gamma": 10**400}}, 422),
        ("motion", {"values": [0.2]}, 422), ("motion", {"values": {"gamma": 0.2}, "quantity": "y"}, 422),
        ("motion", {"values": {"gamma": 0.2}, "quantity": 3}, 422), ("motion", {"values": {"__class__": 1}}, 422),
        ("motion", {"values": {f"p{k}": 1 for k in range(300)}}, 422), ("motion", {"values": {"omega": -1.0}}, 422),
        ("finer", {"ranges": {"gamma": [0.3, 0.2]}}, 422), ("finer", {"ranges": {"omega": [0.1, 0.2]}}, 422),
        ("finer", {"ranges": {"gamma": [0.2, 0.3]}, "count": 10**9}, 422), ("finer", {"ranges": {"gamma": [0.2]}}, 422),
        ("job", {"job": 10**8}, 404), ("job", {"job": -1}, 422), ("job", {}, 422), ("cancel", {"job": "1"}, 422),
        ("export", {"kind": "/etc/passwd"}, 422), ("coexisting", {"along": "nothing"}, 422),
        ("nothing", {}, 404), ("data", {}, 405), ("", {}, 405),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused(client: Client, name: str, body: object, status: int) -> None:
    found, answer, _ = client.ask(name, body)
    assert (found, bool(answer["error"])) == (status, True)


def test_bodies_are_checked_before_they_are_read(client: Client) -> None:
    assert client.ask("motion", raw=b"{", method="POST")[0] == 400
    assert client.ask("motion", raw=b"[]", method="POST")[0] == 400
    assert client.ask("motion", raw=b'{"values": {"gamma": NaN}}', method="POST")[0] == 422
    assert client.ask("motion", raw=b"[" * 60000, method="POST")[0] == 400
    assert client.ask("motion", raw=b" " * 70000, method="POST")[0] == 413
    assert client.ask("motion", raw=b"{}", method="POST", headers={"Content-Type": "text/plain"})[0] == 415
    assert client.ask("motion", raw=b"{}", method="POST", headers={"Content-Length": "-1"})[0] == 411
    assert client.ask("motion", method="GET")[0] == 405
    for method in ("PUT", "DELETE", "PATCH", "OPTIONS"):
        assert client.ask("motion", raw=b"{}", method=method)[0] == 405
    assert client.ask("state")[0] == 200  # and it goes on


def test_a_finer_part_grows_and_ends(client: Client) -> None:
    report, results = client.follow("finer", {"ranges": {"gamma": [0.285, 0.29]}, "count": 5})
    assert (report["error"], report["done"], report["total"]) == ("", 5, 5)
    values = decoded(results[-1]["axes"][0]["values"])
    np.testing.assert_allclose(values, np.linspace(0.285, 0.29, 5))
    assert decoded(results[-1]["period"]).tolist()[0] == 2
    assert decoded(results[-1]["period"]).tolist()[-1] == 4


def test_a_computation_can_be_cancelled(client: Client) -> None:
    _, report, _ = client.ask("finer", {"ranges": {"gamma": [0.3, 0.5]}, "count": 2000})
    assert report["running"]
    client.ask("cancel", {"job": report["job"]})
    until = time.monotonic() + 20
    while report["running"] and time.monotonic() < until:
        _, report, _ = client.ask("job", {"job": report["job"]})
        time.sleep(0.05)
    assert (report["running"], report["error"]) == (False, "cancelled")
    assert report["done"] < 2000


def test_two_wells_coexist(client: Client) -> None:
    """With little forcing the motion stays in either of two wells: the state that is carried along stays in one."""
    report, results = client.follow("coexisting", {"values": {"gamma": 0.2}, "along": "gamma", "quantity": "x"})
    assert report["error"] == ""
    for way in ("up", "down"):
        assert results[-1][way]["label"]["period"] == 1


def test_votes_and_branches_come(client: Client) -> None:
    report, results = client.follow("votes", {"values": {"gamma": 0.29}})
    assert (report["error"], results[-1]["regime"], results[-1]["period"]) == ("", "periodic", 4)
    assert results[-1]["indicators"]["floquet"]["vote"] == "stable"
    report, results = client.follow("branches", {"values": {"gamma": 0.2}})
    assert report["error"] == ""
    (branch,) = results[-1]
    values = decoded(branch["values"]["gamma"])
    assert values.min() == pytest.approx(0.2)
    assert values.max() == pytest.approx(0.29)
    doubled = [e for e in branch["events"] if e["kind"] == "period-doubling"]
    assert len(doubled) == 1
    assert 0.24 < doubled[0]["values"]["gamma"] < 0.28  # between the points of 1T and of 2T


def test_a_defect_has_its_status_and_is_said_in_the_terminal(client: Client, monkeypatch, capsys) -> None:
    def broken(_: object) -> None:
        raise KeyError("speed")

    monkeypatch.setattr(type(client.server.session), "answers", {"motion": broken})
    status, answer, _ = client.ask("motion", {"values": {}})
    assert status == 500 and "KeyError: 'speed'" in answer["error"]
    assert "KeyError: 'speed'" in capsys.readouterr().err


def test_a_sweep_both_ways_names_the_way_of_its_points_while_it_is_computed(exploration: Exploration) -> None:
    both = replace(exploration, follow="both")
    axes, job = {"gamma": (np.linspace(0.28, 0.29, 18).tolist(), "1")}, Results(1)
    compute(job, both, both.system, axes)
    ways = [list(one["section"]) for one in job.all]
    assert ways[0] == ["up"]
    assert ways[-1] == ["up", "down"]
    assert all(found in (["up"], ["up", "down"]) for found in ways)
    said = [one["incomplete"] for one in job.all]
    assert said[0].endswith(" of 36 points computed")
    assert said[-1] == ""
    middle = next(one for one in job.all if len(one["section"]) == 2)
    assert middle["incomplete"]
    down = decoded(middle["section"]["down"]["x"])
    assert np.isnan(down[0]).all()  # the way down has not come here
    assert np.isfinite(down[-1]).any()


class Results(Job):
    """A job that keeps every result that it was given."""

    @property
    def all(self) -> list[Any]:
        return self.__dict__.setdefault("_all", [])

    def put(self, result: Any) -> None:
        self.all.append(result)
        super().put(result)
