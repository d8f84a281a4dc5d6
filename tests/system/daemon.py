"""What the system tests share: a dwelld of one's own, and clients written from proto/dwell/v1 alone.

Nothing here sleeps: every wait is a poll with a time-out, and the time-out is a failure.
"""

import itertools
import os
import re
import select
import signal
import subprocess
import tempfile
import time
import unittest

import zmq

from dwell.v1 import control_pb2, stream_pb2

DWELLD = os.environ["DWELLD"]
SCENARIOS = os.environ["DWELL_SCENARIOS"]
PATIENCE_S = 60  # a sanitizer on a busy machine; a test that waits this long has failed

# Clutter, missed plots, manoeuvres: all of a run that is drawn by chance.
BUSY = """
radar { name: "west" x_m: -40e3 beamwidth_deg: 0.7 false_alarm_probability: 1e-6 clutter_density: 2e-4 }
radar { name: "east" x_m: 40e3 detection_probability: 0.8 clutter_density: 1e-4 }
radar { name: "south" y_m: -30e3 beamwidth_deg: 0.2 detection_probability: 0.9 }
target { name: "one" x_m: 10e3 y_m: 20e3 vx_mps: 150 vy_mps: 20 jump_markov { area { radius_m: 50e3 } } }
target { name: "two" x_m: -20e3 y_m: 30e3 vx_mps: 30 vy_mps: -200 jump_markov { area { radius_m: 50e3 } } }
"""


def soak():
    return os.environ.get("DWELL_SOAK") == "1"


def scaled(count):
    """As tests/scale.hpp: a tenth where a sanitizer is at work."""
    return max(1, count // 10) if os.environ.get("DWELL_TEST_SCALE") == "small" else count


def scenario(name):
    with open(os.path.join(SCENARIOS, name + ".textproto"), encoding="utf-8") as file:
        return file.read()


def run(*arguments):
    """dwelld to its end: exit code, standard output, standard error."""
    done = subprocess.run([DWELLD, *arguments], capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    return done.returncode, done.stdout, done.stderr


def without_epoch(envelope):
    """The bytes of an Envelope after field 1, the epoch: a varint, which comes first."""
    assert envelope[0] == 0x08, "the epoch comes first"
    end = next(i for i in range(1, len(envelope)) if envelope[i] < 0x80)
    return envelope[end + 1:]


def parsed(envelope):
    return stream_pb2.Envelope.FromString(envelope)


class Stream:
    """A subscriber: (topic, envelope bytes), in order."""

    def __init__(self, context, endpoint, topic=b"", receive_hwm=0):
        self.socket = context.socket(zmq.SUB)
        self.socket.linger = 0
        self.socket.rcvhwm = receive_hwm
        self.socket.reconnect_ivl = 10
        self.socket.subscribe(topic)
        self.socket.connect(endpoint)

    def receive(self, timeout_s=PATIENCE_S):
        """The next message; None where there is none in time."""
        if not self.socket.poll(round(1000 * timeout_s)):
            return None
        return self.socket.recv_multipart()

    def messages(self):
        """Parsed envelopes, up to the end of the stream or a silence that is a failure."""
        while True:
            message = self.receive()
            if message is None:
                raise AssertionError(f"no message for {PATIENCE_S} s")
            envelope = parsed(message[1])
            yield envelope
            if envelope.HasField("end_of_stream"):
                return

    def to_the_end(self):
        """Every message as (topic, bytes without epoch), up to the end of the stream."""
        all_messages = []
        while not all_messages or all_messages[-1][0] != b"end.":
            message = self.receive()
            if message is None:
                raise AssertionError(f"no message for {PATIENCE_S} s")
            all_messages.append((message[0], without_epoch(message[1])))
        return all_messages


class Ended(AssertionError):
    """The daemon had ended before it was asked."""


class Control:
    """A client of the control port: one request, one reply."""

    def __init__(self, context, endpoint, process):
        self.process = process
        self.socket = context.socket(zmq.DEALER)
        self.socket.linger = 0
        self.socket.reconnect_ivl = 10
        self.socket.connect(endpoint)
        self.ids = itertools.count(1)

    def send(self, request):
        self.socket.send(request.SerializeToString())

    def receive(self, timeout_s=PATIENCE_S):
        deadline = time.monotonic() + timeout_s
        while not self.socket.poll(100):
            if self.process.poll() is not None:
                raise Ended(f"no reply: the daemon ended with {self.process.returncode}")
            if time.monotonic() > deadline:
                raise AssertionError(f"no reply for {timeout_s} s")
        return control_pb2.Reply.FromString(self.socket.recv())

    def ask(self, request=None, **body):
        """ask(get_status={}) or ask(request); the id is ours where the request has none."""
        if request is None:
            request = control_pb2.Request(client="test", **body)
            for name in body:
                getattr(request, name).SetInParent()  # also where it is empty
        if not request.id:
            request.id = f"test-{id(self)}-{next(self.ids)}"
        self.send(request)
        reply = self.receive()
        assert reply.id == request.id, (reply, request)
        return reply

    def status(self):
        return self.ask(get_status={}).accepted.status


class Daemon:
    """A dwelld on endpoints of its own. Use in a `with`."""

    def __init__(self, directory, config=None, *arguments, tcp=False, high_water_mark=100000):
        self.context = zmq.Context()
        command = [DWELLD]
        if config is not None:
            number = len(os.listdir(directory))
            path = os.path.join(directory, f"{number}.textproto")
            with open(path, "w", encoding="utf-8") as file:
                bind = {port: "tcp://127.0.0.1:0" if tcp else f"ipc://{directory}/{number}.{port}"
                        for port in ("stream", "control")}
                file.write(f'''{config}
stream {{ bind: "{bind["stream"]}" high_water_mark: {high_water_mark} }}
control {{ bind: "{bind["control"]}" }}
''')
            command += ["--config", path]
        self.process = subprocess.Popen([*command, *map(str, arguments)], stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE)
        self.log = b""
        self.output = b""
        self.clients = []

    def __enter__(self):
        try:
            found = self._wait_for_log(rb"stream (\S+), control (\S+),")
        except BaseException:
            self.__exit__()
            raise
        self.stream_endpoint, self.control_endpoint = found.group(1).decode(), found.group(2).decode()
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()
        for client in self.clients:
            client.socket.close()
        self.context.destroy(linger=0)  # also what a failed test left open: term() would wait for ever

    def _wait_for_log(self, pattern):
        deadline = time.monotonic() + PATIENCE_S
        descriptor = self.process.stderr.fileno()
        while not re.search(pattern, self.log):
            ready, _, _ = select.select([descriptor], [], [], max(0.0, deadline - time.monotonic()))
            piece = os.read(descriptor, 65536) if ready else b""
            if not piece:
                raise AssertionError(f"dwelld did not get ready: {self.log!r}")
            self.log += piece
        return re.search(pattern, self.log)

    def stream(self, topic=b"", receive_hwm=0):
        self.clients.append(Stream(self.context, self.stream_endpoint, topic, receive_hwm))
        return self.clients[-1]

    def control(self):
        self.clients.append(Control(self.context, self.control_endpoint, self.process))
        return self.clients[-1]

    def signal(self, number):
        self.process.send_signal(number)

    def wait(self, timeout_s=PATIENCE_S):
        """The exit code."""
        output, log = self.process.communicate(timeout=timeout_s)
        self.output += output
        self.log += log
        return self.process.returncode

    def memory_mib(self):
        with open(f"/proc/{self.process.pid}/status", encoding="ascii") as status:
            return int(re.search(r"VmRSS:\s+(\d+) kB", status.read()).group(1)) / 1024

    def descriptors(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))


class SystemTest(unittest.TestCase):
    maxDiff = 2000

    def setUp(self):
        # Endpoints are paths of at most 107 bytes: in /tmp, wherever TMPDIR points.
        self._directory = tempfile.TemporaryDirectory(prefix="dwell.", dir="/tmp")
        self.addCleanup(self._directory.cleanup)
        self.directory = self._directory.name

    def daemon(self, config, *arguments, **options):
        return Daemon(self.directory, config, *arguments, **options)

    def path(self, name):
        return os.path.join(self.directory, name)

    def published(self, config, *arguments):
        """All that a fast run publishes, to a subscriber that was there from the start."""
        with self.daemon(config, "--fast", "--wait-subscribers", 1, *arguments) as daemon:
            messages = daemon.stream().to_the_end()
            self.assertEqual(daemon.wait(), 0, daemon.log)
        return messages

    def assert_whole(self, envelopes):
        """No gap from the first to the last: in sequence, in topic_sequence of each kind, in scan."""
        numbers = {}
        for envelope in envelopes:
            numbers.setdefault("all", []).append(envelope.sequence)
            numbers.setdefault(envelope.WhichOneof("body"), []).append(envelope.topic_sequence)
            if envelope.HasField("scan_report"):
                numbers.setdefault("scans", []).append(envelope.scan_report.scan)
        for kind, seen in numbers.items():
            gaps = [(before, after) for before, after in zip(seen, seen[1:]) if after != before + 1]
            self.assertEqual(gaps, [], kind)


__all__ = ["BUSY", "Control", "Daemon", "PATIENCE_S", "Stream", "SystemTest", "parsed", "run", "scaled", "scenario",
           "signal", "soak", "without_epoch"]
