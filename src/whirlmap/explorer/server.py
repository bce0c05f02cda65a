"""The server of one page: this computer alone, a token in the address, and nothing of the file system.

Requests are refused with a status: 421 where the host is another one, 403 where the page that asks is, 404 for whatever is
not below the token or is not one of the few names that there are, 405 for another method, 409 for what this page or its
store cannot give, 411, 413 and 415 for a body without length, too long, or of another type, 400 for what is no JSON, 422
for names and numbers that cannot be, and 500 for a defect of the program, which is said in the terminal too.
"""

import json
import secrets
import sys
from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from whirlmap.errors import WhirlmapError
from whirlmap.explorer.encoding import json_text
from whirlmap.explorer.limits import BODY, Refused
from whirlmap.explorer.page import page_html
from whirlmap.explorer.session import Session
from whirlmap.version import __version__

LOOPBACK = "127.0.0.1"
#: Seconds after which a connection that says nothing is closed.
IDLE = 30.0


class Server(ThreadingHTTPServer):
    """Serves the page of a session on the loopback address.

    Parameters
    ----------
    session : Session
    port : int
        0 for any that is free.
    token : str, optional
        A random one where absent; a server that is started again with its token and port keeps its addresses.
    """

    daemon_threads = True
    allow_reuse_address = True

    def __init__(self, session: Session, port: int = 0, token: str | None = None) -> None:
        self.session, self.token = session, token or secrets.token_urlsafe(24)
        super().__init__((LOOPBACK, port), Handler)

    @property
    def port(self) -> int:
        """The port."""
        return int(self.server_address[1])

    @property
    def address(self) -> str:
        """Where the page is."""
        return f"http://{LOOPBACK}:{self.port}/{self.token}/"

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing where a page has gone before its answer came."""


class Handler(BaseHTTPRequestHandler):
    """Checks and answers one request; the connection ends with it, so that nothing is answered once the server has ended."""

    server: Server
    server_version, sys_version = f"whirlmap/{__version__}", ""
    timeout = IDLE

    def do_GET(self) -> None:
        """Answer the page itself, its data, and whether kernels are compiled."""
        self._answered(self._got)

    def do_POST(self) -> None:
        """Answer a request in JSON."""
        self._answered(self._posted)

    def do_PUT(self) -> None:
        """Refuse other methods."""
        self._answered(self._not_allowed)

    do_DELETE = do_PATCH = do_OPTIONS = do_HEAD = do_PUT

    def _answered(self, answer: Callable[[], None]) -> None:
        """Answer; what goes wrong has its status and its reason, and a defect is said in the terminal too."""
        try:
            answer()
        except Refused as refused:
            self._refuse(refused)
        except WhirlmapError as error:
            self._refuse(Refused(HTTPStatus.UNPROCESSABLE_ENTITY, str(error)))
        except OSError:  # the page has gone before its answer came
            raise
        except Exception as error:  # the page would wait for an answer
            reason = f"the program has a defect here: {type(error).__name__}: {error}"
            print(f"whirlmap explore: {reason}", file=sys.stderr, flush=True)
            self._refuse(Refused(HTTPStatus.INTERNAL_SERVER_ERROR, reason))

    def _got(self) -> None:
        name = self._checked()
        if name == "":
            nonce = secrets.token_urlsafe(16)
            self._send(HTTPStatus.OK, page_html(nonce=nonce), "text/html; charset=utf-8", nonce)
        elif name in ("data", "state"):
            self._json(HTTPStatus.OK, getattr(self.server.session, name)())
        elif name in self.server.session.answers:
            raise Refused(HTTPStatus.METHOD_NOT_ALLOWED, "expected POST")
        else:
            raise Refused(HTTPStatus.NOT_FOUND, "there is nothing here")

    def _posted(self) -> None:
        name = self._checked()
        answer = self.server.session.answers.get(name)
        if answer is None:
            wrong = name in ("", "data", "state")
            status = HTTPStatus.METHOD_NOT_ALLOWED if wrong else HTTPStatus.NOT_FOUND
            raise Refused(status, "expected GET" if wrong else "there is nothing here")
        self._json(HTTPStatus.OK, answer(self._body()))

    def _not_allowed(self) -> None:
        self._checked()
        raise Refused(HTTPStatus.METHOD_NOT_ALLOWED, "expected GET or POST")

    def _checked(self) -> str:
        """Refuse whatever does not come from this page; the name that is asked for."""
        hosts = {f"{LOOPBACK}:{self.server.port}", f"localhost:{self.server.port}"}
        host = self.headers.get("Host", "")
        if host not in hosts:
            raise Refused(HTTPStatus.MISDIRECTED_REQUEST, "another host")
        origin = self.headers.get("Origin")
        if origin is not None and origin != f"http://{host}":
            raise Refused(HTTPStatus.FORBIDDEN, "another origin")
        if self.headers.get("Sec-Fetch-Site", "same-origin") not in ("same-origin", "none"):
            raise Refused(HTTPStatus.FORBIDDEN, "another site")
        token, slash, name = self.path.removeprefix("/").partition("/")
        if not slash or not secrets.compare_digest(token.encode(), self.server.token.encode()):
            raise Refused(HTTPStatus.NOT_FOUND, "there is nothing here")
        return name

    def _body(self) -> dict[str, Any]:
        if self.headers.get_content_type() != "application/json":
            raise Refused(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "expected application/json")
        length = self.headers.get("Content-Length", "")
        if not (length.isascii() and length.isdigit()):
            raise Refused(HTTPStatus.LENGTH_REQUIRED, "expected the length of the body")
        if len(length) > 9 or int(length) > BODY:
            raise Refused(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"expected at most {BODY} bytes")
        try:
            found = json.loads(self.rfile.read(int(length)))
        except (ValueError, RecursionError):
            raise Refused(HTTPStatus.BAD_REQUEST, "expected JSON") from None
        if not isinstance(found, dict):
            raise Refused(HTTPStatus.BAD_REQUEST, "expected a JSON object")
        return found

    def _json(self, status: HTTPStatus, value: Any) -> None:
        self._send(status, json_text(value), "application/json")

    def _refuse(self, refused: Refused) -> None:
        self._send(refused.status, json_text({"error": refused.reason}), "application/json")

    def _send(self, status: HTTPStatus, text: str, kind: str, nonce: str = "") -> None:
        content = text.encode()
        policy = "default-src 'none'"
        if nonce:
            policy += (
                f"; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; connect-src 'self'; img-src data: blob:"
                "; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
            )
        self.send_response(status)
        for header, value in (
            ("Content-Type", kind), ("Content-Length", str(len(content))), ("Content-Security-Policy", policy),
            ("X-Content-Type-Options", "nosniff"), ("Referrer-Policy", "no-referrer"), ("Cache-Control", "no-store"),
            ("Cross-Origin-Resource-Policy", "same-origin"), ("Cross-Origin-Opener-Policy", "same-origin"),
        ):  # fmt: skip
            self.send_header(header, value)
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *arguments: Any) -> None:  # noqa: A002 (the name that the library gives it)
        """Write no log: addresses hold the token."""
