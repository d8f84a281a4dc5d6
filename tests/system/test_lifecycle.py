"""How a run ends: signals, commands, and what the last message says."""

import random
import time
import unittest

from daemon import BUSY, SystemTest, parsed, scaled, signal, soak

PERIOD = "scan_period_s: 0.01\n"


class Lifecycle(SystemTest):
    def end(self, daemon, stream, envelopes, ask_to_end):
        """Asks, reads to the end; the seconds it took until the process was gone."""
        asked = time.monotonic()
        ask_to_end()
        envelopes.extend(stream.messages())
        self.assertEqual(daemon.wait(), 0, daemon.log)
        return time.monotonic() - asked

    def assert_ended(self, envelopes, reason):
        self.assert_whole(envelopes)
        last = envelopes[-1]
        self.assertEqual(last.end_of_stream.final_sequence, last.sequence)
        self.assertEqual(last.end_of_stream.reason, reason)

    def test_sigterm_at_any_instant_ends_within_2_s_with_the_final_sequence(self):
        instants = random.Random(1)
        slowest = 0.0
        for _ in range(100 if soak() else scaled(20)):
            with self.daemon(PERIOD + BUSY, "--wait-subscribers", 1) as daemon:
                stream = daemon.stream()
                envelopes = [parsed(stream.receive()[1])]
                until = time.monotonic() + instants.uniform(0.0, 0.2)
                while (left := until - time.monotonic()) > 0:
                    if (message := stream.receive(left)) is not None:
                        envelopes.append(parsed(message[1]))
                slowest = max(slowest, self.end(daemon, stream, envelopes, lambda: daemon.signal(signal.SIGTERM)))
                self.assert_ended(envelopes, "terminated")
                self.assertIn(b"position RMS", daemon.output, "the summary")
        print(f"slowest end: {slowest:.3f} s", flush=True)
        self.assertLess(slowest, 2.0)

    def test_sigint_says_interrupted(self):
        with self.daemon(PERIOD + BUSY, "--wait-subscribers", 1) as daemon:
            stream = daemon.stream()
            envelopes = [parsed(stream.receive()[1])]
            self.end(daemon, stream, envelopes, lambda: daemon.signal(signal.SIGINT))
            self.assert_ended(envelopes, "interrupted")

    def test_stop_says_who(self):
        with self.daemon(PERIOD + BUSY, "--wait-subscribers", 1) as daemon:
            stream, control = daemon.stream(), daemon.control()
            envelopes = [parsed(stream.receive()[1])]
            self.end(daemon, stream, envelopes, lambda: control.ask(stop={}))
            self.assert_ended(envelopes, "stopped by test")

    def test_ends_while_it_waits_for_subscribers_or_is_paused(self):
        with self.daemon(PERIOD + BUSY, "--fast", "--wait-subscribers", 3) as daemon:
            daemon.signal(signal.SIGTERM)
            self.assertEqual(daemon.wait(), 0)
        with self.daemon(PERIOD + BUSY) as daemon:
            self.assertTrue(daemon.control().ask(pause={}).HasField("accepted"))
            daemon.signal(signal.SIGTERM)
            self.assertEqual(daemon.wait(), 0)

    def test_ends_in_a_fast_run_that_never_waits(self):
        with self.daemon(BUSY, "--fast") as daemon:
            self.assertGreaterEqual(daemon.control().status().scan, 0)
            daemon.signal(signal.SIGTERM)
            self.assertEqual(daemon.wait(), 0)

    def test_epoch_is_new_at_every_start(self):
        epochs = []
        for _ in range(3):
            with self.daemon(BUSY, "--fast", "--wait-subscribers", 1, "--scans", 5) as daemon:
                envelopes = list(daemon.stream().messages())
                self.assertEqual({envelope.epoch for envelope in envelopes}, {envelopes[0].epoch})
                epochs.append(envelopes[0].epoch)
        self.assertEqual(sorted(set(epochs)), epochs)


if __name__ == "__main__":
    unittest.main()
