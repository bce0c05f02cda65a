"""A diagram of Duffing's oscillator with its cascade of period doublings, and a server of it."""

import http.client
import json
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

import whirlmap
from whirlmap.explorer.exploration import Exploration, opened
from whirlmap.explorer.server import Server
from whirlmap.explorer.session import Session

#: Values of the forcing at which the motion returns after 1T, 2T and 4T (known to be so for delta = 0.3, omega = 1.2).
RETURNS = {0.2: 1, 0.28: 2, 0.29: 4}


@dataclass
class Client:
    """Asks a server."""

    server: Server

    def ask(self, name: str, body: Any = None, *, method: str = "", raw: bytes | None = None, token: str = "",
            headers: dict[str, str] | None = None) -> tuple[int, Any, dict[str, str]]:  # fmt: skip
        """Status, JSON (or text) and headers of an answer."""
        connection = http.client.HTTPConnection("127.0.0.1", self.server.port, timeout=120)
        content = raw if raw is not None else None if body is None else json.dumps(body).encode()
        kind = {} if content is None else {"Content-Type": "application/json"}
        path = name if name.startswith("/") else f"/{token or self.server.token}/{name}"
        connection.request(method or ("GET" if content is None else "POST"), path, content, {**kind, **(headers or {})})
        answer = connection.getresponse()
        text = answer.read().decode()
        found = json.loads(text) if answer.headers.get_content_type() == "application/json" else text
        connection.close()
        return answer.status, found, dict(answer.headers)

    def follow(self, name: str, body: Any) -> Any:
        """The last report of a job, and all results on the way."""
        status, report, _ = self.ask(name, body)
        assert status == 200, report
        results, version = [], 0
        while True:
            status, report, _ = self.ask("job", {"job": report["job"], "version": version})
            if "result" in report:
                results.append(report["result"])
                version = report["version"]
            if not report["running"]:
                return report, results


@pytest.fixture(scope="session")
def diagram(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of a diagram over the cascade."""
    file = tmp_path_factory.mktemp("explorer") / "duffing.nc"
    ds = whirlmap.bifurcation_diagram(whirlmap.load("duffing"), "gamma", [0.2, 0.24, 0.28, 0.285, 0.29], lyapunov=0)
    ds.to_netcdf(file)
    return file


@pytest.fixture(scope="session")
def exploration(diagram: Path) -> Exploration:
    found = opened(str(diagram))
    assert found is not None
    return found


@pytest.fixture(scope="module")
def client(exploration: Exploration) -> Iterator[Client]:
    """Asks a server of the diagram."""
    with Session(exploration) as session, Server(session) as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05})
        thread.start()
        yield Client(server)
        server.shutdown()
        thread.join()
