"""UM-Bridge in both directions, as its users meet it: models behind servers, and a study's model behind ours.

Time limits of the study are 0.5 to 20 s against servers that sleep for longer, and a stop must be answered within 3 s: a busy
machine may make an answer late that should not be. Servers take the ports that the system gives them.

    python3 umbridge_test.py PATH_TO_MOTTLE

Of the protocol's conformity test (UM-Bridge/umbridge, testing/protocol_conformity_1.0), which needs packages that Debian does
not have together, the checks are re-created here from what they demand: keys, types, sizes, kinds of error and status of each
answer.
"""

import http.client
import json
import math
import signal
import socket
import subprocess
import threading
import time

import support
from served_model import HEAD, POINTS, REST, SHORT, UmbridgeTest, eigenvalues, hertz, slopes
from support import read_result


class AsClient(UmbridgeTest):
    def assert_close(self, found, wanted, digits=1e-12):
        self.assertEqual(len(found), len(wanted))
        for a, b in zip(found, wanted):
            self.assertLessEqual(abs(float(a) - b), digits * abs(b))

    def test_its_frequencies_are_the_servers(self):
        model = self.model()
        self.study(model)
        rows = self.cloud()
        for row, point in zip(rows, ([2, 2], [1.5, 2.5], [3, 1], [2.2, 2.1])):
            self.assert_close(row[2:4], [hertz(value) for value in eigenvalues(*point)])
        self.assertEqual(model.evaluations()[0], {"name": "two masses", "config": {}, "input": [[2.0, 2.0]]})

    def test_the_update_is_that_of_the_same_model_built_in(self):
        self.study(self.model())
        self.springs()
        self.succeed("update", "study.toml", "--out", "a", "--quiet")
        self.succeed("update", "direct.toml", "--out", "b", "--quiet")
        a, b = read_result(self.folder / "a"), read_result(self.folder / "b")
        for key in ("mean", "std"):  # the frequencies differ in their last digits, which differences enlarge
            self.assert_close(a["parameters"][key], b["parameters"][key], 1e-6)
        self.assertEqual(a["failed_evaluations"], [])

    def test_quantities(self):
        for quantity, outputs in (("rad/s", lambda x, _: [[math.sqrt(v) for v in eigenvalues(*x[0])]]),
                                  ("eigenvalue", lambda x, _: [eigenvalues(*x[0])])):
            self.study(self.model(outputs=outputs), more=f'quantity = "{quantity}"\n')
            self.assert_close(self.cloud()[1][2:4], [hertz(value) for value in eigenvalues(1.5, 2.5)])

    def test_inputs_by_name_with_constants_config_and_one_of_several_outputs(self):
        def outputs(x, config):
            return [[0.0], [hertz(value) * config["scale"] for value in eigenvalues(x[1][0], x[0][1])]]

        model = self.model(sizes=[2, 1], output_sizes=[1, 2], outputs=outputs, models=["other", "two masses"])
        self.study(model, more='name = "two masses"\ninputs = [[7.5, "k2"], ["k1"]]\noutput = 1\n'
                               'config = { scale = 1.0, list = [1, "a", true] }\n')
        self.assert_close(self.cloud()[1][2:4], [hertz(value) for value in eigenvalues(1.5, 2.5)])
        self.assertEqual(model.evaluations()[2]["input"], [[7.5, 2.5], [1.5]])
        self.assertEqual(model.evaluations()[2]["config"], {"scale": 1.0, "list": [1, "a", True]})

    def test_frequencies_keep_their_positions_where_they_cross(self):
        self.study(self.model(outputs=lambda x, _: [x[0]]))
        for row in self.cloud():
            self.assertAlmostEqual(float(row[2]), float(row[0]), 12)
            self.assertAlmostEqual(float(row[3]), float(row[1]), 12)

    def test_requests_are_spread_and_results_stay_in_order(self):
        def slowly(path, request, number):
            time.sleep(0.05 if number % 2 else 0.0)

        servers = [self.model(spoil=slowly) for _ in range(3)]
        self.study(*servers, more="parallel = 6\n")
        rows = self.cloud()
        for row, point in zip(rows, ([2, 2], [1.5, 2.5], [3, 1], [2.2, 2.1])):
            self.assert_close(row[2:4], [hertz(value) for value in eigenvalues(*point)])
        self.assertGreaterEqual(sum(server.count > 0 for server in servers), 2)
        self.succeed("propagate", "study.toml", "--out", "q", "--quiet", "--set", "update.samples=60")
        self.assertTrue(all(server.count >= 10 for server in servers), [server.count for server in servers])
        self.assertTrue(all(server.most_at_once <= 4 for server in servers))

    def test_derivatives_are_the_servers(self):
        for features, path in ((("Evaluate", "Gradient"), "/Gradient"), (("Evaluate", "ApplyJacobian"), "/ApplyJacobian"),
                               (("Evaluate", "Gradient", "ApplyJacobian"), "/ApplyJacobian")):
            model = self.model(features=features)
            self.study(model, more="derivatives = true\n")
            chosen = ["--quiet", "--set", 'update.method="deterministic"', "--set", "update.iterations=30"]
            self.succeed("update", "study.toml", "--out", "a", *chosen)
            asked = {path for path, _ in model.seen} - {"/Info", "/ModelInfo", "/InputSizes", "/OutputSizes", "/Evaluate"}
            self.assertEqual(asked, {path})
            self.springs()
            self.succeed("update", "direct.toml", "--out", "b", *chosen)
            a, b = read_result(self.folder / "a"), read_result(self.folder / "b")
            self.assert_close(a["parameters"]["mean"], b["parameters"]["mean"], 1e-6)
            self.assertIn(path[1:], self.succeed("check", "study.toml").out)
        without = self.model(features=("Evaluate", "Gradient"))
        self.study(without, more="derivatives = false\n")
        self.succeed("update", "study.toml", "--out", "c", *chosen)
        self.assertNotIn("/Gradient", {path for path, _ in without.seen})

    def test_derivatives_that_fail_are_told_with_their_number(self):
        def fail(path, _, number):
            return (500, b"no adjoint here") if path == "/Gradient" and number > 1 else None

        self.study(self.model(features=("Evaluate", "Gradient"), spoil=fail))
        self.succeed("update", "study.toml", "--out", "a", "--quiet", "--set", 'update.method="deterministic"')
        notes = [note for note in read_result(self.folder / "a")["notes"] if "a request for derivatives failed" in note]
        self.assertEqual(len(notes), 1)
        self.assertRegex(notes[0], r"\d+ of the \d+ times .*HTTP 500: 'no adjoint here'")
        self.assertEqual((self.folder / "a" / "mottle.log").read_text().count("a request for derivatives failed"), 1)
        self.study(self.model(features=("Evaluate", "Gradient")))
        self.succeed("update", "study.toml", "--out", "b", "--quiet", "--set", 'update.method="deterministic"')
        self.assertNotIn("a request for derivatives failed", (self.folder / "b" / "mottle.log").read_text())

    def test_capitals_of_a_scheme_are_the_same(self):
        self.study(self.model().url.replace("http", "HTTP"))
        self.cloud()

    def test_no_more_requests_are_under_way_than_parallel_says(self):
        """Jacobians at several points are asked for by several threads, of which each asks for several columns."""
        model = self.model(features=("Evaluate", "ApplyJacobian"),
                           spoil=lambda path, *_: time.sleep(0.02) if path in ("/Evaluate", "/ApplyJacobian") else None)
        self.study(model, more="parallel = 3\n")
        self.succeed("update", "study.toml", "--out", "a", "--quiet", "--threads", "4", "--set",
                     'update.method="maximum-likelihood"', "--set", "update.iterations=2")
        self.assertIn("/ApplyJacobian", {path for path, _ in model.seen})
        self.assertEqual(model.most_at_once, 3)

    def test_a_server_that_fails_at_once_does_not_draw_the_requests(self):
        """A proxy whose model is down: each of its answers costs a try, and there are two."""
        down = self.model(spoil=lambda path, _, number: (503, b"no backend") if path == "/Evaluate" and number > 0 else None)
        up = self.model(spoil=lambda path, *_: time.sleep(0.02) if path == "/Evaluate" else None)
        self.study(up, down, more="parallel = 4\n")
        self.succeed("propagate", "study.toml", "--out", "a", "--quiet", "--set", "model.retries=1", "--set",
                     "update.samples=100")
        self.assertEqual(read_result(self.folder / "a")["failed_evaluations"], [])
        self.assertLess(down.count, 20)

    def reasons(self, faults, timeout_s=20):
        """Why points failed whose answer a fault (body, status) replaced; the good point after each must have its numbers."""
        def spoil(path, request, _):
            number = round(request["input"][0][0]) - 10 if path == "/Evaluate" else -1
            if 0 <= number < len(faults):
                body, status = faults[number]() if callable(faults[number]) else faults[number]
                return status, body
            return None

        self.study(self.model(spoil=spoil), more="largest_failed_part = 1.0\n")
        self.write("points.csv", "k1,k2\n" + "".join(f"{10 + i},2\n{2 + 0.01 * i},2.1\n" for i in range(len(faults))))
        rows = self.cloud("--set", f'model.timeout="{timeout_s} s"', "--set", "update.max_failed=1.0")
        for i in range(len(faults)):
            self.assert_close(rows[2 * i + 1][2:4], [hertz(value) for value in eigenvalues(2 + 0.01 * i, 2.1)])
        failed = read_result(self.folder / "p")["failed_evaluations"]
        self.assertEqual([failure["sample"] for failure in failed], list(range(0, 2 * len(faults), 2)))
        return [failure["reason"] for failure in failed]

    def test_faults_cost_their_sample(self):
        """What a server may do wrong once it has answered at the means."""
        good = json.dumps({"output": [[0.1, 0.3]]}).encode()
        faults = (
            (b'{"error": {"type": "InvalidInput", "message": "the mesh\\u001b[31m folds"}}', 400, "InvalidInput: the mesh"),
            (b'{"error": {"type": "InvalidOutput", "message": "diverged"}}', 200, "InvalidOutput: diverged"),
            (b"Traceback (most recent call last)", 500, "HTTP 500"),
            (good, 301, "HTTP 301: the server refers to another address"),
            (b"hello", 200, "not JSON"),
            (b"", 200, "not JSON"),
            (b'{"output": [[NaN, 0.3]]}', 200, "not JSON"),
            (b'{"output": [[null, 0.3]]}', 200, "'null', which is not a number"),
            (b'{"output": [["0.1", 0.3]]}', 200, "not a number"),
            (b'{"output": [[1e999, 0.3]]}', 200, "not JSON"),
            (b'{"output": [[-0.1, 0.3]]}', 200, "not negative"),
            (b'{"output": [[1e200, 0.3]]}', 200, "too large"),
            (b'{"output": [[0.1]]}', 200, "output[0] has 1 numbers, 2 were promised"),
            (b'{"output": [[0.1, 0.3], [1]]}', 200, "output has 2 vectors, 1 were promised"),
            (b'{"output": [0.1, 0.3]}', 200, "output has 2 vectors"),
            (b'{"outputs": [[0.1, 0.3]]}', 200, "no list 'output'"),
            (b"[]", 200, "not an object"),
            (b"[" * 100000, 200, "not JSON"),
            (b"\xff\xfe\x00", 200, "not JSON"),
            (b"x" * (17 << 20), 200, "longer than 16 MiB"),
            (b"SSH-2.0-OpenSSH_9.2\r\n", None, "not HTTP"),
            (b"HTTP/1.1 200 OK\r\nContent-Length: 50\r\n\r\n{", None, "ended before the answer"),
            (b"", None, "ended before the answer"))
        found = self.reasons([(body, status) for body, status, _ in faults])
        for (body, status, reason), told in zip(faults, found):
            with self.subTest(body=body[:60], status=status):
                self.assertIn(reason, told)
                self.assertTrue(told.startswith(("http://127.0.0.1:", "output[", "a frequency")), told)
                self.assertNotIn("\x1b", told)

    def test_answers_belong_to_their_requests(self):
        """Interim answers before one and bytes behind one shift nothing, on connections that are kept."""
        def whole(output):
            body = json.dumps({"output": [output]}).encode()
            return b"HTTP/1.1 200 OK\r\nContent-Length: %d\r\n\r\n%s" % (len(body), body)

        def spoil(path, request, number):
            if path != "/Evaluate" or number == 1:
                return None
            good = whole([hertz(value) for value in eigenvalues(*request["input"][0])])
            return 0, (b"HTTP/1.1 100 Continue\r\n\r\n" + good,
                       b"HTTP/1.1 102 Processing\r\n\r\nHTTP/1.1 103 Early Hints\r\nLink: a\r\n\r\n" + good,
                       good + whole([0.1, 0.2]),
                       good)[number % 4]

        self.study(self.model(spoil=spoil))
        self.write("points.csv", "k1,k2\n" + "".join(f"{1 + 0.1 * i},2\n" for i in range(40)))
        rows = self.cloud()
        self.assertEqual(len(rows), 40)
        for i, row in enumerate(rows):
            self.assert_close(row[2:4], [hertz(value) for value in eigenvalues(1 + 0.1 * i, 2)])

    def test_a_job_that_a_dead_server_ended_goes_on_when_it_is_back(self):
        down = []

        def spoil(path, _, number):
            if path != "/Evaluate":
                return None
            time.sleep(0.06)
            return (None, b"") if number > 10 and not down else None

        model = self.model(spoil=spoil)
        self.study(model)
        ended = self.call("update", "study.toml", "--out", "a", *SHORT)
        self.assertEqual(ended.code, 3, ended.err)
        down.append("no longer")
        self.succeed("update", "study.toml", "--out", "a", *SHORT, "--resume")
        self.assertEqual(read_result(self.folder / "a")["failed_evaluations"], [])

    def test_a_slow_server_costs_its_sample(self):
        def sleep():
            time.sleep(4)
            return b"", 500

        told, = self.reasons([sleep], timeout_s=2)
        self.assertIn("no answer within 2 s", told)

    def test_a_failed_request_is_tried_again_elsewhere(self):
        bad = self.model(spoil=lambda path, _, number: (500, b"no") if path == "/Evaluate" and number > 1 else None)
        good = self.model()
        self.study(bad, good)
        self.cloud("--set", "model.retries=1")
        self.assertEqual(read_result(self.folder / "p")["failed_evaluations"], [])
        alone = self.model(spoil=lambda path, _, number: (503, b"busy") if path == "/Evaluate" and number in (3, 4) else None)
        self.study(alone)
        self.cloud("--set", "model.retries=2")
        self.assertEqual(alone.count, 1 + 4 + 2)

    def test_a_server_that_dies_stops_the_job(self):
        model = self.model(spoil=lambda path, _, number: (None, b"") if path == "/Evaluate" and number > 10 else None)
        self.study(model)
        ended = self.call("update", "study.toml", "--out", "a", "--quiet")
        self.assertEqual(ended.code, 3)
        self.assertIn("evaluations by the servers failed, at most 25 % may", ended.err)

    def test_one_of_two_servers_that_dies_costs_nothing(self):
        dying = self.model()
        self.study(dying, self.model(spoil=lambda *_: time.sleep(0.01)))

        def die(path, _, number):
            if number < 3:
                return None
            dying.socket.close()
            return None, b""  # and no answer by what is still connected

        dying.spoil = die
        self.succeed("propagate", "study.toml", "--out", "a", "--quiet", "--set", "model.retries=2")
        self.assertEqual(read_result(self.folder / "a")["failed_evaluations"], [])

    # The first contact: one error.
    def refusal(self, code, *servers, more=""):
        self.study(*servers, more=more)
        ended = self.call("check", "study.toml", timeout=30)
        self.assertEqual(ended.code, code, ended.err)
        self.assertEqual(len(ended.err.splitlines()), 1, ended.err)
        return ended.err

    def test_first_contact(self):
        with socket.socket() as unused:
            unused.bind(("127.0.0.1", 0))
            dead = f"http://127.0.0.1:{unused.getsockname()[1]}"
        self.assertIn("no connection: Connection refused; is the model's server running?", self.refusal(3, dead))
        self.assertIn("no connection", self.refusal(3, self.model(), dead))
        self.assertIn("the host 'no-such-host.invalid' is not found", self.refusal(3, "http://no-such-host.invalid:80"))
        garbage = self.model(spoil=lambda *_: (404, b"<html>"))
        self.assertIn("/Info does not answer as UM-Bridge's protocol 1.0 says: HTTP 404", self.refusal(3, garbage))
        failing = self.model(spoil=lambda path, *_: (500, b"{}") if path == "/Evaluate" else None)
        self.assertIn("the model gives nothing at the parameters' means", self.refusal(3, failing))
        silent = self.model(spoil=lambda *_: time.sleep(3))
        self.assertIn("no answer within 0.5 s", self.refusal_with(silent, 'model.timeout="0.5 s"'))
        self.assertIn("model.urls: ", self.refusal(2, self.model(version=0.9)))
        self.assertIn("model.name: is missing", self.refusal(2, self.model(models=["two masses", "b"])))
        self.assertIn("model.name: ", self.refusal(2, self.model(), more='name = "two mases"\n'))
        self.assertIn("model.name: ", self.refusal(2, self.model(features=("Gradient",))))
        self.assertIn("model.inputs: is missing; the model's inputs have the sizes [3], 3 numbers in all, and there are 2 "
                      "parameters", self.refusal(2, self.model(sizes=[3])))
        self.assertIn("model.inputs: has the sizes [1], the model's inputs have [2]",
                      self.refusal(2, self.model(), more='inputs = ["k1"]\n'))
        self.assertIn("parameter 'k2': acts on nothing", self.refusal(2, self.model(), more='inputs = ["k1", 2]\n'))
        self.assertIn("model.inputs: ", self.refusal(2, self.model(), more='inputs = ["k1", "k3"]\n'))
        self.assertIn("model.output: is 1, and the model has 1 output vectors", self.refusal(2, self.model(), more="output = 1\n"))
        self.assertIn("do not offer the same", self.refusal(2, self.model(), self.model(sizes=[1, 1])))
        self.assertIn("inputSizes has '-1'", self.refusal(3, self.model(sizes=[-1])))

    def refusal_with(self, server, setting):
        self.study(server)
        ended = self.call("check", "study.toml", "--set", setting)
        self.assertEqual(ended.code, 3)
        return ended.err

    def test_faults_of_the_keys(self):
        for more, wanted in (('inputs = ["k1", true]\n', "neither a parameter's name nor a number"),
                             ('inputs = [["k1"], 2]\n', "model.inputs"),
                             ("config = 3\n", "model.config"),
                             ("config = { day = 2020-01-01 }\n", "cannot be said in JSON"),
                             ("config = { x = nan }\n", "cannot be said in JSON"),
                             ('quantity = "kHz"\n', "model.quantity"),
                             ("parallel = 0\n", "model.parallel"),
                             ("speed = 1\n", "speed")):
            self.study("http://127.0.0.1:1", more=more)
            ended = self.call("check", "study.toml")
            self.assertEqual(ended.code, 2, more)
            self.assertIn(wanted, ended.err)
        for url, wanted in (("https://a", "is https"), ("127.0.0.1:4", "does not begin with http://"),
                            ("http://a:0", "not a port"), ("http://a:70000", "not a port"), ("http://u@a", "character"),
                            ("http://", "names no host"), ("http://a/?q", "character"), ("http://[::1", "[ without ]"),
                            ("http://a b", "character"), ("http://a/\\r\\nX: y", "character"),
                            ("http://user:pw@host:1", "names a user"), ("http://host:1?x=1", "a query or a fragment"),
                            ("http://host/a#b", "a query or a fragment")):
            self.study(url.replace("\\r\\n", "\r\n"))
            ended = self.call("check", "study.toml")
            self.assertEqual(ended.code, 2, url)
            self.assertIn(wanted, ended.err)
            self.assertIn("study.toml:6: model.urls", ended.err)
            self.assertNotIn("pw", ended.err)
        self.study("http://a:1", "http://b", "HTTP://A:1/")
        ended = self.call("check", "study.toml")
        self.assertEqual(ended.code, 2)
        self.assertIn("model.urls: names http://a:1 twice", ended.err)
        ended = self.call("check", "study.toml", "--set", "model.urls=[]")
        self.assertEqual(ended.code, 2)
        self.assertEqual(ended.err.count("model.urls:"), 1, ended.err)

    def test_no_run_asks_nobody(self):
        model = self.model()
        self.study(model)
        ended = self.call("check", "study.toml", "--no-run")
        self.assertEqual(ended.code, 2)
        self.assertIn(model.url, ended.err)
        self.assertEqual(model.seen, [])

    def test_a_killed_job_goes_on_where_it_was(self):
        slow = self.model()
        self.study(slow)
        self.succeed("update", "study.toml", "--out", "whole", *SHORT)
        wanted, count = read_result(self.folder / "whole")["parameters"], slow.count
        slow.spoil = lambda path, *_: time.sleep(0.06) if path == "/Evaluate" else None
        job = subprocess.Popen([support.MOTTLE, "update", "study.toml", "--out", "a", *SHORT], cwd=self.folder)
        while slow.count < count + 15:
            time.sleep(0.01)
        job.kill()
        job.wait()
        slow.spoil = None
        asked = len(slow.evaluations())
        self.succeed("update", "study.toml", "--out", "a", *SHORT, "--resume")
        self.assertEqual(read_result(self.folder / "a")["parameters"], wanted)
        again = [json.dumps(r["input"]) for r in slow.evaluations()[asked:]]
        before = {json.dumps(r["input"]) for r in slow.evaluations()[count:asked - 1]}
        self.assertEqual([x for x in again if x in before], ["[[2.0, 2.0]]"], "the means alone, to see that it is the same model")

    def test_a_resumed_job_refuses_another_model(self):
        slow = self.model(spoil=lambda path, *_: time.sleep(0.06) if path == "/Evaluate" else None)
        self.study(slow)
        job = subprocess.Popen([support.MOTTLE, "update", "study.toml", "--out", "a", *SHORT], cwd=self.folder)
        while slow.count < 10:
            time.sleep(0.01)
        job.kill()
        job.wait()
        slow.spoil = None
        slow.outputs = lambda x, _: [[hertz(value) * 1.001 for value in eigenvalues(*x[0])]]
        ended = self.call("update", "study.toml", "--out", "a", *SHORT, "--resume")
        self.assertEqual(ended.code, 2)
        self.assertIn("their model has changed", ended.err)
        self.succeed("update", "study.toml", "--out", "a", *SHORT)

    def test_an_answer_that_came_while_the_job_was_suspended_is_taken(self):
        """As a scheduler suspends jobs: the time limit is over when it goes on, and the answer is there."""
        asked = threading.Event()

        def spoil(path, request, _):
            if path == "/Evaluate" and request["input"][0][0] == 3:
                asked.set()
                time.sleep(0.5)

        self.study(self.model(spoil=spoil), more="largest_failed_part = 1.0\n")
        job = subprocess.Popen([support.MOTTLE, "propagate", "study.toml", "--points", "points.csv", "--out", "p", "--quiet",
                                "--set", 'model.timeout="2 s"', "--set", "update.max_failed=1.0"], cwd=self.folder)
        self.assertTrue(asked.wait(30 * support.PATIENCE))
        job.send_signal(signal.SIGSTOP)
        time.sleep(3)
        job.send_signal(signal.SIGCONT)
        self.assertEqual(job.wait(30 * support.PATIENCE), 0)
        self.assertEqual(read_result(self.folder / "p")["failed_evaluations"], [])

    def test_a_stop_request_is_answered_while_a_server_is_silent(self):
        silent = self.model(spoil=lambda path, _, number: time.sleep(5) if path == "/Evaluate" and number > 3 else None)
        self.study(silent)
        job = subprocess.Popen([support.MOTTLE, "update", "study.toml", "--out", "a", "--quiet"], cwd=self.folder,
                               stderr=subprocess.PIPE, text=True)
        while silent.count < 4:
            time.sleep(0.01)
        begin = time.monotonic()
        job.send_signal(signal.SIGINT)
        self.assertEqual(job.wait(10), 4)
        self.assertIn("stopped on request; go on with --resume", job.stderr.read())
        job.stderr.close()
        self.assertLess(time.monotonic() - begin, 3.0 * support.PATIENCE)


class AsServer(UmbridgeTest):
    def setUp(self):
        super().setUp()
        self.springs()
        self.address = None

    def offer(self, *more, study="direct.toml"):
        job = subprocess.Popen([support.MOTTLE, "propagate", study, "--umbridge", "0", "--json", *more], cwd=self.folder,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

        def end():
            job.kill()
            job.wait()
            job.stdout.close()
            job.stderr.close()

        self.addCleanup(end)
        line = job.stdout.readline()
        self.assertTrue(line, "" if line else job.stderr.read())
        self.offered = json.loads(line)
        self.address = self.offered["address"]
        return job

    def ask(self, path, request=None, raw=None, method=None, headers=None):
        """Status and answer."""
        host, port = self.address.removeprefix("http://").split(":")
        connection = http.client.HTTPConnection(host, int(port), timeout=30 * support.PATIENCE)
        body = raw if raw is not None else None if request is None else json.dumps(request)
        connection.request(method or ("GET" if body is None else "POST"), path, body, headers or {})
        answer = connection.getresponse()
        text = answer.read()
        connection.close()
        return answer.status, json.loads(text) if text else None

    def refused(self, path, request, status=400, kind="InvalidInput", **how):
        """The protocol's error object, to the letter of its schema; returns the message."""
        found, answer = self.ask(path, request, **how)
        self.assertEqual(found, status, answer)
        self.assertEqual(set(answer), {"error"})
        self.assertEqual(set(answer["error"]), {"type", "message"})
        self.assertEqual(answer["error"]["type"], kind)
        self.assertIsInstance(answer["error"]["message"], str)
        return answer["error"]["message"]

    def test_what_is_offered(self):
        self.offer()
        self.assertEqual(self.offered, {"command": "propagate", "status": "offered", "address": self.address,
                                        "model": "forward", "inputs": ["k1", "k2"], "outputs": ["f1", "f2"],
                                        "derivatives": True})
        self.assertTrue(self.address.startswith("http://127.0.0.1:"))
        self.assertEqual({p.name for p in self.folder.iterdir()}, {"study.toml", "direct.toml", "tests.csv", "points.csv"})

    def test_conformity(self):
        """The checks of the protocol's own conformity test, in its order."""
        self.offer()
        name = {"name": "forward"}
        x = {"name": "forward", "config": {}, "input": [[2.0, 2.0]]}
        self.assertEqual(self.ask("/", method="HEAD")[0] // 100, 4)
        self.assertEqual(self.ask("/Info"), (200, {"protocolVersion": 1.0, "models": ["forward"]}))
        self.assertEqual(self.ask("/ModelInfo", name), (200, {"support": {
            "Evaluate": True, "Gradient": True, "ApplyJacobian": True, "ApplyHessian": False}}))
        self.assertEqual(self.ask("/InputSizes", name), (200, {"inputSizes": [2]}))
        self.assertEqual(self.ask("/OutputSizes", name), (200, {"outputSizes": [2]}))
        status, answer = self.ask("/Evaluate", x)
        self.assertEqual((status, set(answer), len(answer["output"]), len(answer["output"][0])), (200, {"output"}, 1, 2))
        wrong = {"name": "wrong_model_name"}
        for path in ("/Evaluate", "/ModelInfo", "/InputSizes", "/OutputSizes", "/Gradient", "/ApplyJacobian", "/ApplyHessian"):
            self.refused(path, wrong, kind="ModelNotFound")
        self.refused("/Evaluate", {**x, "input": [[2.0, 2.0, 2.0]]})
        for path, key in (("/Gradient", "sens"), ("/ApplyJacobian", "vec")):
            good = {**x, "outWrt": 0, "inWrt": 0, key: [0, 0]}
            status, answer = self.ask(path, good)
            self.assertEqual((status, set(answer), answer["output"]), (200, {"output"}, [0.0, 0.0]))
            self.refused(path, {**good, "input": [[2.0, 2.0, 2.0]]})
            self.refused(path, {**good, "inWrt": 1})
            self.refused(path, {**good, "outWrt": 1})
            self.refused(path, {**good, key: [0, 0, 0]})
        self.refused("/ApplyHessian", name, kind="UnsupportedFeature")

    def test_numbers(self):
        """Eigenvalues of two masses and their derivatives, by hand."""
        self.offer()
        k = [1.5, 2.5]
        values = [hertz(value) for value in eigenvalues(*k)]
        request = {"name": "forward", "input": [k], "outWrt": 0, "inWrt": 0}
        found = self.ask("/Evaluate", request)[1]["output"][0]
        rows = [[slope / (8 * math.pi ** 2 * f) for slope in row] for row, f in zip(slopes(*k), values)]
        gradient = self.ask("/Gradient", {**request, "sens": [0.5, -2.0]})[1]["output"]
        product = self.ask("/ApplyJacobian", {**request, "vec": [3.0, 1.0]})[1]["output"]
        for i in range(2):
            self.assertAlmostEqual(found[i], values[i], 14)
            self.assertAlmostEqual(gradient[i], 0.5 * rows[0][i] - 2.0 * rows[1][i], 12)
            self.assertAlmostEqual(product[i], 3.0 * rows[i][0] + rows[i][1], 12)

    def test_bad_requests_are_told_and_harm_nobody(self):
        job = self.offer()
        x = {"name": "forward", "input": [[2.0, 2.0]]}
        for raw in (b"", b"hello", b"[]", b"{", b"[" * 1000000, b'{"name": "\xff"}', b"\x00" * 100,
                    b'{"name": "forward", "input": [[NaN, 1]]}', b'{"name": "forward", "input": [[1e999, 1]]}'):
            self.refused("/Evaluate", None, raw=raw)
        for given in (None, 3, "a", [], {}, [2.0, 2.0], [[2.0]], [[2.0, None]], [[2.0, "2"]], [[2.0, True]], [[2.0, 2.0], []],
                      [[[2.0], [2.0]]]):
            self.refused("/Evaluate", {**x, "input": given})
        self.refused("/Evaluate", {"name": "forward"})
        for model in (None, 1, [], "FORWARD", "x" * 10000):
            self.refused("/Evaluate", {**x, "name": model}, kind="ModelNotFound")
        self.assertIn("physically impossible", self.refused("/Evaluate", {**x, "input": [[-1.0, 2.0]]}))
        for wrt in (-1, "0", None, 1e30, [0], 0.5, True):
            self.refused("/Gradient", {**x, "outWrt": wrt, "inWrt": 0, "sens": [1, 1]})
        self.refused("/Gradient", x)
        self.refused("/Nothing", x, status=404)
        self.refused("/Evaluate", None, status=405)
        self.refused("/Evaluate", None, status=405, method="DELETE")
        self.refused("/Evaluate", x, status=403, headers={"Origin": "http://page.example"})
        self.refused("/Evaluate", None, status=413, raw=b"x" * (5 << 20))
        self.refused("/Info" + "x" * 20000, None, status=413)
        self.assertEqual(self.ask("/Evaluate", x)[0], 200)
        self.assertIsNone(job.poll())

    def raw(self, text, wait=5):
        """What comes back for bytes that need not be HTTP."""
        host, port = self.address.removeprefix("http://").split(":")
        with socket.create_connection((host, int(port)), timeout=wait * support.PATIENCE) as stream:
            stream.sendall(text)
            stream.shutdown(socket.SHUT_WR)
            answer = b""
            while part := stream.recv(65536):
                answer += part
        return answer

    def test_what_is_no_http_ends_its_connection_alone(self):
        self.offer()
        for text in (b"SSH-2.0-x\r\n\r\n", b"\x16\x03\x01\x00", b"", b"POST /Evaluate HTTP/1.1\r\nContent-Length: 10\r\n\r\n{",
                     b"POST /Evaluate HTTP/1.1\r\nContent-Length: -4\r\n\r\n",
                     b"POST /Evaluate HTTP/1.1\r\nContent-Length: 99999999999999999999\r\n\r\n",
                     b"POST /Evaluate HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n", b"\r\n" * 100000):
            try:
                self.raw(text)
            except ConnectionError:
                pass
        self.assertEqual(self.ask("/Info")[0], 200)

    def test_many_clients_at_once(self):
        self.offer()
        wanted, found = {}, {}

        def client(i):
            for j in range(25):
                k = [1.0 + 0.1 * i, 2.0 + 0.01 * j]
                wanted[i, j] = [hertz(value) for value in eigenvalues(*k)]
                found[i, j] = self.ask("/Evaluate", {"name": "forward", "input": [k]})[1]["output"][0]

        clients = [threading.Thread(target=client, args=(i,)) for i in range(16)]
        idle = [socket.create_connection(("127.0.0.1", int(self.address.rsplit(":", 1)[1]))) for _ in range(50)]
        for thread in clients:
            thread.start()
        for thread in clients:
            thread.join()
        for stream in idle:
            stream.close()
        self.assertEqual(len(found), 400)
        for key, values in wanted.items():
            for a, b in zip(found[key], values):
                self.assertAlmostEqual(a, b, 13)

    def test_a_signal_ends_it(self):
        for kind in (signal.SIGINT, signal.SIGTERM):
            job = self.offer("--quiet")
            self.assertEqual(self.ask("/Info")[0], 200)
            job.send_signal(kind)
            self.assertEqual(job.wait(10), 4)
            self.assertEqual(job.stderr.read(), "mottle: stopped on request; the model is no longer offered\n")

    def test_a_signal_during_a_long_computation_ends_it_in_the_same_words(self):
        """A chain whose eigenvalues take half a second, in which nobody looks for a stop."""
        count = 560
        masses = ", ".join(f"m{i} = 1.0" for i in range(count))
        springs = "\n".join(f'  {{ name = "k{i}", between = ["{f"m{i - 1}" if i else "ground"}", "m{i}"], stiffness = 1.0 }},'
                            for i in range(count))
        rest = REST.replace('name = "k1"\n', 'name = "k1"\ntarget = "spring:k1"\n')
        rest = rest.replace('name = "k2"\n', 'name = "k2"\ntarget = "spring:k2"\n')
        self.write("chain.toml", f'{HEAD}[model]\nkind = "mass-spring"\nmasses = {{ {masses} }}\nsprings = [\n{springs}\n]\n\n{rest}')
        job = self.offer(study="chain.toml")
        host, port = self.address.removeprefix("http://").split(":")
        with socket.create_connection((host, int(port))) as stream:
            body = json.dumps({"name": "forward", "input": [[2.0, 2.0]]})
            stream.sendall(f"POST /Evaluate HTTP/1.1\r\nHost: a\r\nContent-Length: {len(body)}\r\n\r\n{body}".encode())
            time.sleep(0.15)
            job.send_signal(signal.SIGTERM)
            self.assertEqual(job.wait(20 * support.PATIENCE), 4)
        self.assertEqual([line for line in job.stderr.read().splitlines() if "stopped" in line],
                         ["mottle: stopped on request; the model is no longer offered"])

    def test_faults_of_the_options(self):
        self.offer()
        port = self.address.rsplit(":", 1)[1]
        ended = self.call("propagate", "direct.toml", "--umbridge", port)
        self.assertEqual(ended.code, 2)
        self.assertIn(f"port {port} of 127.0.0.1 cannot be had: Address already in use", ended.err)
        for more in (["--umbridge", "70000"], ["--umbridge", "0", "--points", "points.csv"], ["--umbridge", "0", "--out", "a"],
                     ["--umbridge", "x"]):
            self.assertEqual(self.call("propagate", "direct.toml", *more).code, 2, more)

    def test_a_model_that_fails_is_told(self):
        """Of a model by UM-Bridge that is itself behind a server: runs that fail are the clients' errors, and it goes on."""
        behind = self.model(spoil=lambda path, request, _: (500, b"boom") if path == "/Evaluate" and request["input"][0][0] == 3 else None)
        self.study(behind)
        self.offer(study="study.toml")
        self.assertFalse(self.offered["derivatives"])
        for _ in range(30):
            self.assertIn("HTTP 500: 'boom'", self.refused("/Evaluate", {"name": "forward", "input": [[3.0, 1.0]]}, status=500, kind="InvalidOutput"))
        self.assertEqual(self.ask("/Evaluate", {"name": "forward", "input": [[2.0, 2.0]]})[0], 200)
        self.refused("/Gradient", {"name": "forward", "input": [[2.0, 2.0]]}, kind="UnsupportedFeature")

    def test_failures_of_some_clients_are_not_told_to_others(self):
        """Most requests fail, and those that do not are computed together with them."""
        def spoil(path, request, _):
            time.sleep(0.01)
            return (500, b"boom") if path == "/Evaluate" and request["input"][0][0] == 3 else None

        self.study(self.model(spoil=spoil), more="parallel = 4\n")
        self.offer(study="study.toml")
        found = {}

        def client(i):
            k1 = 2.0 if i % 4 == 0 else 3.0
            for j in range(8):
                found[i, j] = k1, self.ask("/Evaluate", {"name": "forward", "input": [[k1, 2.0]]})

        clients = [threading.Thread(target=client, args=(i,)) for i in range(16)]
        for thread in clients:
            thread.start()
        for thread in clients:
            thread.join()
        self.assertEqual(len(found), 128)
        for k1, (status, answer) in found.values():
            self.assertEqual(status, 200 if k1 == 2.0 else 500, answer)
            if status == 500:
                self.assertIn("HTTP 500: 'boom'", answer["error"]["message"])

    def test_as_the_client_of_itself_the_update_is_the_same(self):
        self.offer()
        for method in ("covariance-adjustment", "maximum-likelihood"):
            chosen = ["--quiet", "--set", f'update.method="{method}"']
            self.study(self.address)
            self.succeed("update", "study.toml", "--out", "a", *chosen)
            self.succeed("update", "direct.toml", "--out", "b", *chosen)
            a, b = read_result(self.folder / "a"), read_result(self.folder / "b")
            for key in ("mean", "std"):
                for found, wanted in zip(a["parameters"][key], b["parameters"][key]):
                    # f goes as text and comes back as (2 pi f)^2: the last digit, enlarged by the method's iterations
                    self.assertLessEqual(abs(found - wanted), 1e-6 * wanted, method)


if __name__ == "__main__":
    support.main()
