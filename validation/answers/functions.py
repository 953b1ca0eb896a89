"""A server of the UM-Bridge protocol for functions of one list of numbers."""
import http.server
import json
import threading

STARTED = {}  # id of a function: its server


class Handler(http.server.BaseHTTPRequestHandler):
    """Answers of one function."""
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True

    def log_message(self, *_):
        """Says nothing."""

    def answer(self, value):
        body = json.dumps(value).encode()
        self.send_response(200)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def do_GET(self):  # noqa: N802
        self.answer({"protocolVersion": 1.0, "models": ["forward"]})

    def do_POST(self):  # noqa: N802
        asked = json.loads(self.rfile.read(int(self.headers.get("Content-Length", 0))) or "{}")
        function = self.server.function
        verb = self.path.strip("/")
        if verb == "ModelInfo":
            self.answer({"support": {"Evaluate": True, "Gradient": False, "ApplyJacobian": False, "ApplyHessian": False}})
        elif verb == "InputSizes":
            self.answer({"inputSizes": [len(function.inputs)]})
        elif verb == "OutputSizes":
            self.answer({"outputSizes": [function.outputs]})
        else:
            self.answer({"output": [function.value(asked["input"][0])]})


def address_of(function):
    """URL of the function's server, which is started at the first call."""
    if id(function) not in STARTED:
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        server.daemon_threads = True
        server.function = function
        threading.Thread(target=server.serve_forever, daemon=True).start()
        STARTED[id(function)] = server
    return f"http://127.0.0.1:{STARTED[id(function)].server_address[1]}"
