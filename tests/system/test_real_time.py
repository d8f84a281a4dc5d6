"""A run by the wall clock: one scan a period, a Status every second, pause and step."""

import time
import unittest

from daemon import BUSY, PATIENCE_S, SystemTest, parsed
from dwell.v1 import stream_pb2

PERIOD_S = 0.05
CONFIG = f"scan_period_s: {PERIOD_S}\n" + BUSY


class RealTime(SystemTest):
    def test_one_scan_a_period(self):
        with self.daemon(CONFIG, "--wait-subscribers", 1) as daemon:
            stream, control = daemon.stream(), daemon.control()
            envelopes = [parsed(stream.receive()[1])]
            until = time.monotonic() + 2.0
            while (left := until - time.monotonic()) > 0:
                if (message := stream.receive(left)) is not None:
                    envelopes.append(parsed(message[1]))
            self.assert_whole(envelopes)
            scans = [envelope for envelope in envelopes if envelope.HasField("scan_report")]
            for envelope in scans:
                self.assertEqual(envelope.time_ns, round(envelope.scan_report.scan * PERIOD_S * 1e9))
            missed = control.status().wall_clock.missed_scans
            # Never early; how many are late is the machine's affair, and they are counted.
            self.assertLessEqual(len(scans), 2.0 / PERIOD_S + 2)
            print(f"{len(scans)} scans in 2 s, {missed} missed", flush=True)
            self.assertGreaterEqual(len(scans) + missed, 2.0 / PERIOD_S - 2)

    def test_status_comes_every_second_also_when_paused(self):
        with self.daemon(CONFIG, "--wait-subscribers", 1) as daemon:
            stream, control = daemon.stream(b"status."), daemon.control()
            arrivals, runs = [], []

            def next_status():
                message = stream.receive(PATIENCE_S)
                self.assertIsNotNone(message)
                arrivals.append(time.monotonic())
                runs.append(parsed(message[1]).status.run)

            next_status()
            next_status()
            self.assertTrue(control.ask(pause={}).HasField("accepted"))
            for _ in range(3):
                next_status()
            self.assertEqual(runs[-2:], [stream_pb2.Status.PAUSED] * 2)
            gaps = [after - before for before, after in zip(arrivals, arrivals[1:])]
            print("seconds between statuses:", " ".join(f"{gap:.3f}" for gap in gaps), flush=True)
            self.assertLess(max(gaps), 1.5)
            self.assertGreater(min(gaps), 0.5)

    def test_pause_step_resume(self):
        with self.daemon(CONFIG, "--wait-subscribers", 1) as daemon:
            stream, control = daemon.stream(b"scan."), daemon.control()
            self.assertIsNotNone(stream.receive())
            paused = control.ask(pause={}).accepted.status.scan
            seen = 1
            while seen < paused:
                seen = parsed(stream.receive()[1]).scan_report.scan
            self.assertIsNone(stream.receive(4 * PERIOD_S), "no scan while it is paused")
            self.assertTrue(control.ask(step={"scans": 5}).HasField("accepted"))
            for scan in range(paused + 1, paused + 6):
                self.assertEqual(parsed(stream.receive()[1]).scan_report.scan, scan)
            self.assertIsNone(stream.receive(4 * PERIOD_S), "five and no more")
            self.assertEqual(control.status().scan, paused + 5)
            missed = control.status().wall_clock.missed_scans
            self.assertTrue(control.ask(resume={}).HasField("accepted"))
            self.assertEqual(parsed(stream.receive()[1]).scan_report.scan, paused + 6)
            self.assertEqual(control.status().wall_clock.missed_scans, missed, "a pause misses no scan")


if __name__ == "__main__":
    unittest.main()
