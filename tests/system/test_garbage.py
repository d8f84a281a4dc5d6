"""Random bytes on both ports: no crash, no missed scan, and a good client is served afterwards."""

import random
import socket
import time
import unittest

import zmq

from daemon import BUSY, PATIENCE_S, SystemTest, parsed, scaled, soak
from dwell.v1 import control_pb2

STRINGS = 100_000 if soak() else scaled(2000)  # to each port
PERIOD_S = 0.25

# What a ZMTP peer begins with: signature, version 3.1, mechanism NULL, as client.
GREETING = b"\xff\0\0\0\0\0\0\0\1\x7f\3\1NULL" + bytes(16) + bytes(32)


def address(endpoint):
    host, port = endpoint.removeprefix("tcp://").rsplit(":", 1)
    return host, int(port)


def garbage(chance):
    """Some of it is nearly right: that gets deeper."""
    bytes_ = chance.randbytes(chance.randrange(1, 300))
    kind = chance.randrange(4)
    if kind == 0:
        return GREETING + bytes_
    if kind == 1:
        return GREETING[:chance.randrange(1, len(GREETING))] + bytes_
    if kind == 2:
        return bytes([len(bytes_) % 256, chance.randrange(2)]) + bytes_  # a frame of ZMTP 1.0
    return bytes_


class Garbage(SystemTest):
    def throw(self, target, number, chance):
        connection = socket.socket()
        # Sources of their own, so that tens of thousands of closed connections do not use up the ports.
        connection.bind((f"127.0.{number // 200 % 200 + 1}.{number % 200 + 1}", 0))
        connection.settimeout(PATIENCE_S)
        try:
            connection.connect(target)
            connection.sendall(garbage(chance))
        except ConnectionError:
            pass  # it hung up on us, as it should
        # Most hang up at once; some stay, and say no more.
        self.held.append(connection)
        if chance.randrange(8) or len(self.held) > 50:
            self.held.pop(chance.randrange(len(self.held)) if chance.randrange(2) else -1).close()

    def test_random_bytes_on_both_ports(self):
        chance = random.Random(3)
        self.held = []
        with self.daemon(f"scan_period_s: {PERIOD_S}\n" + BUSY, "--wait-subscribers", 1, tcp=True) as daemon:
            stream, control = daemon.stream(b"scan."), daemon.control()
            self.assertIsNotNone(stream.receive())
            before = control.status()
            descriptors = daemon.descriptors()
            started = time.monotonic()
            for number in range(STRINGS):
                self.throw(address(daemon.stream_endpoint), number, chance)
                self.throw(address(daemon.control_endpoint), number, chance)
            self.throw_messages(daemon, STRINGS // 4, chance)
            seconds = time.monotonic() - started

            asked = time.monotonic()
            after = daemon.control().status()
            self.assertLess(time.monotonic() - asked, 1.0, "a good client is served")
            self.assertEqual(after.wall_clock.missed_scans, before.wall_clock.missed_scans)
            self.assertGreaterEqual(after.scan - before.scan, int(seconds / PERIOD_S) - 1)
            while parsed(stream.receive()[1]).scan_report.scan <= after.scan:
                pass  # what was published meanwhile; then the next one
            self.assertGreater(after.wall_clock.requests_unreadable, before.wall_clock.requests_unreadable)
            self.assertTrue(daemon.control().ask(set_policy={"text": "fixed"}).HasField("accepted"))
            self.assertLess(daemon.memory_mib(), 256)
            for connection in self.held:
                connection.close()
            while descriptors < daemon.descriptors() - 20:  # half-open ones are given 2 s
                self.assertIsNotNone(stream.receive())
                self.assertLess(time.monotonic(), started + seconds + PATIENCE_S)
            print(f"2 x {STRINGS} strings in {seconds:.1f} s, {after.scan - before.scan} scans, "
                  f"{after.wall_clock.requests_unreadable} unreadable requests", flush=True)
            control.ask(stop={})
            self.assertEqual(daemon.wait(), 0, daemon.log)

    def throw_messages(self, daemon, count, chance):
        """Random bytes in sound ZMTP: as requests, as subscriptions."""
        requests, subscriptions = daemon.context.socket(zmq.DEALER), daemon.context.socket(zmq.XSUB)
        for peer in (requests, subscriptions):
            peer.linger = 0
            peer.sndtimeo = 1000 * PATIENCE_S
        requests.connect(daemon.control_endpoint)
        subscriptions.connect(daemon.stream_endpoint)
        try:
            answered = 0
            for _ in range(count):
                message = self.message(chance)
                requests.send_multipart([message] if chance.randrange(4) else [b"", message, message])
                subscriptions.send(message)
                while requests.poll(0):
                    control_pb2.Reply.FromString(requests.recv_multipart()[-1])
                    answered += 1
            # The daemon may be slower than we are: half of the messages have an answer, if not yet.
            self.assertTrue(answered or requests.poll(1000 * PATIENCE_S))
        finally:
            requests.close()
            subscriptions.close()

    def message(self, chance):
        if chance.randrange(2):
            return chance.randbytes(chance.randrange(0, 200))
        request = control_pb2.Request(id="x" * chance.randrange(1, 70), client="garbage")
        # Now and then one as large as a request may be, with as much wrong in it.
        request.set_policy.text = "sa_imm:nodes=7" if chance.randrange(8) else "sa_imm" + ":a" * chance.randrange(30000)
        changed = bytearray(request.SerializeToString())
        for _ in range(chance.randrange(1, 6)):
            changed[chance.randrange(len(changed))] = chance.randrange(256)
        return bytes(changed)

    def test_request_beyond_the_largest_size_cuts_the_connection_alone(self):
        with self.daemon(f"scan_period_s: {PERIOD_S}\n" + BUSY) as daemon:
            large = daemon.context.socket(zmq.DEALER)
            large.linger = 0
            large.connect(daemon.control_endpoint)
            large.send(bytes(1 << 20))
            self.assertGreaterEqual(daemon.control().status().scan, 0)
            self.assertFalse(large.poll(0))
            large.close()


if __name__ == "__main__":
    unittest.main()
