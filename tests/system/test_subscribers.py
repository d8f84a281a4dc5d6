"""Subscribers that are late, slow or stopped."""

import subprocess
import sys
import unittest

from daemon import BUSY, PATIENCE_S, SystemTest, parsed, signal

HIGH_WATER_MARK = 2000  # a third of a second at the rate below: a healthy reader never gets there

# Reads until it has seen a hole, and says between which sequence numbers.
READER = """
import sys, zmq
from dwell.v1 import stream_pb2
socket = zmq.Context().socket(zmq.SUB)
socket.rcvhwm = 10
socket.subscribe(b"")
socket.connect(sys.argv[1])
last = None
while True:
    assert socket.poll(60000)
    sequence = stream_pb2.Envelope.FromString(socket.recv_multipart()[1]).sequence
    if last is None:
        print("reading", flush=True)
    elif sequence != last + 1:
        print(last, sequence, flush=True)
        break
    last = sequence
"""


class Subscribers(SystemTest):
    def test_stopped_subscriber_harms_nobody_and_sees_its_hole(self):
        with self.daemon("scan_period_s: 0.001\n" + BUSY, "--wait-subscribers", 1,
                         high_water_mark=HIGH_WATER_MARK) as daemon:
            healthy, control = daemon.stream(), daemon.control()
            envelopes = [parsed(healthy.receive()[1])]
            with subprocess.Popen([sys.executable, "-c", READER, daemon.stream_endpoint], stdout=subprocess.PIPE,
                                  text=True) as sick:
                try:
                    self.assertEqual(sick.stdout.readline(), "reading\n")
                    sick.send_signal(signal.SIGSTOP)
                    while control.status().wall_clock.subscriber_overflows == 0:
                        for _ in range(1000):
                            envelopes.append(parsed(healthy.receive()[1]))
                    for _ in range(2000):  # a hole of some size
                        envelopes.append(parsed(healthy.receive()[1]))
                    sick.send_signal(signal.SIGCONT)
                    # The hole is seen once there is something behind it: the run goes on meanwhile.
                    for _ in range(1000):
                        envelopes.append(parsed(healthy.receive()[1]))
                    before, after = map(int, sick.stdout.readline().split())
                finally:
                    sick.kill()
            self.assertGreater(after, before + 1)
            control.ask(stop={})
            envelopes.extend(healthy.messages())
            self.assert_whole(envelopes)
            print(f"healthy: {len(envelopes)} messages without a gap; stopped: {before} then {after}", flush=True)

    def test_late_joiner_has_a_snapshot_that_fits_the_stream(self):
        with self.daemon("scan_period_s: 0.02\n" + BUSY) as daemon:
            first = daemon.stream(b"scan.")
            while parsed(first.receive()[1]).scan_report.scan < 20:
                pass
            for _ in range(10):
                self.join(daemon)

    def join(self, daemon):
        """Subscribe, ask, drop what is older than the snapshot, apply the rest: the state is that of a later snapshot."""
        stream, control = daemon.stream(), daemon.control()
        self.assertIsNotNone(stream.receive(), "the subscription is there")
        snapshot = control.ask(get_snapshot={}).accepted.snapshot
        tracks = {track.id: track for track in snapshot.track}
        last_scan, policy = snapshot.last_scan, snapshot.policy
        later = None
        sequence = snapshot.sequence
        scans = 0
        while later is None or sequence < later.sequence:
            envelope = parsed(stream.receive(PATIENCE_S)[1])
            if envelope.sequence <= snapshot.sequence:
                continue
            self.assertEqual(envelope.epoch, snapshot.epoch)
            self.assertEqual(envelope.sequence, sequence + 1)
            sequence = envelope.sequence
            if envelope.HasField("track"):
                tracks[envelope.track.id] = envelope.track
            elif envelope.HasField("policy_change"):
                policy = envelope.policy_change.to
            elif envelope.HasField("scan_report"):
                last_scan = envelope.scan_report
                scans += 1
            if scans == 5 and later is None:
                text = "fixed" if policy.HasField("sa_imm") else "sa_imm"
                control.ask(set_policy={"text": text})
                later = control.ask(get_snapshot={}).accepted.snapshot
        self.assertEqual(tracks, {track.id: track for track in later.track})
        self.assertEqual(last_scan, later.last_scan)
        self.assertEqual(policy, later.policy)

    def test_topic_filter_sees_its_own_sequence_without_gaps(self):
        with self.daemon(BUSY, "--fast", "--wait-subscribers", 1, "--scans", 200) as daemon:
            stream = daemon.stream(b"scan.")
            for scan in range(1, 201):
                envelope = parsed(stream.receive()[1])
                self.assertEqual((envelope.scan_report.scan, envelope.topic_sequence), (scan, scan))


if __name__ == "__main__":
    unittest.main()
