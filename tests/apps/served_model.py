"""Models behind UM-Bridge servers, of Python's own http.server: what tests share that have Mottle for the servers' client."""

import http.server
import json
import math
import threading

import support
from support import read_csv

# Two masses of 1 kg in a row, ground - k1 - m1 - k2 - m2: lambda = (k1 + 2 k2) / 2 -+ sqrt(k1^2 / 4 + k2^2).
MODEL = """\
[model]
kind = "umbridge"
urls = ["URL"]
timeout = "20 s"
retries = 0
"""

SPRINGS = """\
[model]
kind = "mass-spring"
masses = { m1 = 1.0, m2 = 1.0 }
springs = [
  { name = "k1", between = ["ground", "m1"], stiffness = 1.0 },
  { name = "k2", between = ["m1", "m2"], stiffness = 1.0 },
]
"""

REST = support.two_masses(samples=40, iterations=3)

HEAD = 'title = "Two masses in a row"\nseed = 3\n\n'
# Of an update whose evaluations are slow enough to be stored (50 ms).
SHORT = ("--quiet", "--set", "update.samples=20", "--set", "update.iterations=1")
POINTS = "k1,k2\n2,2\n1.5,2.5\n3,1\n2.2,2.1\n"


def eigenvalues(k1, k2):
    mean, half = (k1 + 2 * k2) / 2, math.sqrt(k1 * k1 / 4 + k2 * k2)
    return [mean - half, mean + half]


def slopes(k1, k2):
    """d lambda / d (k1, k2), a row a mode."""
    half = math.sqrt(k1 * k1 / 4 + k2 * k2)
    return [[0.5 - k1 / 4 / half, 1 - k2 / half], [0.5 + k1 / 4 / half, 1 + k2 / half]]


def hertz(value):
    return math.sqrt(value) / (2 * math.pi)


class Model(http.server.ThreadingHTTPServer):
    """A served model whose answers a test can spoil."""

    daemon_threads = True

    def __init__(self, **what):
        self.name = what.get("name", "two masses")
        self.models = what.get("models", [self.name])
        self.version = what.get("version", 1.0)
        self.features = what.get("features", ("Evaluate",))
        self.sizes = what.get("sizes", [2])
        self.output_sizes = what.get("output_sizes", [2])
        self.outputs = what.get("outputs", lambda x, config: [[hertz(value) for value in eigenvalues(*x[0])]])
        self.spoil = what.get("spoil")  # (path, request, number of the evaluation) -> (status, bytes) or None
        self.count = 0
        self.seen = []
        self.at_once = self.most_at_once = 0
        self.lock = threading.Lock()
        super().__init__(("127.0.0.1", what.get("port", 0)), Handler)
        threading.Thread(target=self.serve_forever, args=(0.02,), daemon=True).start()

    @property
    def url(self):
        return f"http://127.0.0.1:{self.server_address[1]}"

    def handle_error(self, request, client_address):
        """A client that has gone is what some tests are about."""

    def evaluations(self):
        return [request for path, request in self.seen if path == "/Evaluate"]

    def derivative(self, path, request):
        """Of the frequencies, by hand."""
        x = request["input"][0]
        rows = [[slope / (8 * math.pi ** 2 * hertz(value)) for slope in row]
                for row, value in zip(slopes(*x), eigenvalues(*x))]
        if path == "/Gradient":
            return [sum(request["sens"][i] * rows[i][p] for i in range(2)) for p in range(2)]
        return [sum(row[p] * request["vec"][p] for p in range(2)) for row in rows]

    def answer(self, path, request):
        if path == "/Info":
            return {"protocolVersion": self.version, "models": self.models}
        if path == "/ModelInfo":
            return {"support": {name: name in self.features for name in ("Evaluate", "Gradient", "ApplyJacobian", "ApplyHessian")}}
        if path == "/InputSizes":
            return {"inputSizes": self.sizes}
        if path == "/OutputSizes":
            return {"outputSizes": self.output_sizes}
        if path == "/Evaluate":
            return {"output": self.outputs(request["input"], request["config"])}
        return {"output": self.derivative(path, request)}


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True  # head and body are two packets, of which the second would wait 40 ms for the client's word

    def log_message(self, *_):
        pass

    def do_GET(self):
        self.reply({})

    def do_POST(self):
        self.reply(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))

    def reply(self, request):
        server = self.server
        with server.lock:
            server.seen.append((self.path, request))
            server.count += self.path == "/Evaluate"
            server.at_once += 1
            server.most_at_once = max(server.most_at_once, server.at_once)
            number = server.count
        spoilt = server.spoil and server.spoil(self.path, request, number)
        status, body = spoilt or (200, json.dumps(server.answer(self.path, request)).encode())
        with server.lock:
            server.at_once -= 1
        if status is None or status == 0:  # not even HTTP; 0: and the connection stays
            self.wfile.write(body)
            self.close_connection = status is None
            return
        self.send_response(status)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)


class UmbridgeTest(support.CommandTest):
    def setUp(self):
        super().setUp()
        self.write("tests.csv", support.TWO_MASSES_TESTS)
        self.write("points.csv", POINTS)

    def model(self, **what):
        server = Model(**what)
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        return server

    def study(self, *servers, more="", rest=REST):
        urls = json.dumps([server if isinstance(server, str) else server.url for server in servers])
        return self.write("study.toml", HEAD + MODEL.replace('["URL"]', urls) + more + rest)

    def springs(self, name="direct.toml"):
        rest = REST
        for spring in ("k1", "k2"):
            rest = rest.replace(f'name = "{spring}"\n', f'name = "{spring}"\ntarget = "spring:{spring}"\n')
        return self.write(name, HEAD + SPRINGS + rest)

    def cloud(self, *more):
        """Rows of numbers and status of the given points."""
        self.succeed("propagate", "study.toml", "--points", "points.csv", "--out", "p", "--quiet", *more)
        return read_csv(self.folder / "p" / "cloud.csv")[1]
