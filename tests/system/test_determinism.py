"""Same config, seed and commands: the same published bytes, epoch aside."""

import hashlib
import unittest

from daemon import BUSY, SystemTest, run, scenario
from dwell.v1 import stream_pb2


def digest(messages):
    total = hashlib.sha256()
    for topic, envelope in messages:
        total.update(b"%d %d " % (len(topic), len(envelope)) + topic + envelope)
    return total.hexdigest()


def envelopes(messages):
    return [stream_pb2.Envelope.FromString(envelope) for _, envelope in messages]


class Determinism(SystemTest):
    def test_ten_runs_of_ten_publish_the_same_bytes(self):
        config = scenario("evans_three")
        runs = [self.published(config, "--scans", 60, "--seed", 7) for _ in range(10)]
        self.assertEqual({digest(messages) for messages in runs}, {digest(runs[0])})
        self.assertNotEqual(digest(self.published(config, "--scans", 60, "--seed", 8)), digest(runs[0]))

    def test_chance_of_every_kind_is_the_same_too(self):
        first = self.published(BUSY, "--scans", 500)
        self.assertEqual(digest(self.published(BUSY, "--scans", 500)), digest(first))

    def test_calibration_takes_effect_at_the_same_scans(self):
        config = BUSY + "calibration { mode: APPLY period_scans: 60 delay_scans: 7 }\n"
        runs = [self.published(config, "--scans", 200) for _ in range(3)]
        self.assertEqual({digest(messages) for messages in runs}, {digest(runs[0])})
        effective = [m.radar_calibration.effective_scan for m in envelopes(runs[0]) if m.HasField("radar_calibration")]
        self.assertEqual(sorted(set(effective)), [22, 37, 67, 127, 187])
        self.assertNotEqual(digest(runs[0]), digest(self.published(BUSY, "--scans", 200)))

    def test_seed_of_the_command_line_is_that_of_the_config(self):
        by_flag = self.published(BUSY, "--scans", 50, "--seed", 5)
        self.assertEqual(digest(self.published(BUSY + "seed: 5\n", "--scans", 50)), digest(by_flag))

    def test_every_sequence_number_reaches_a_subscriber_from_the_start(self):
        messages = envelopes(self.published(scenario("evans_three"), "--scans", 60, "--seed", 7))
        self.assert_whole(messages)
        self.assertEqual((messages[0].sequence, messages[0].topic_sequence), (1, 1))
        self.assertEqual(messages[-1].end_of_stream.final_sequence, len(messages))
        self.assertEqual(messages[-1].end_of_stream.reason, "all scans done")
        self.assertEqual(sum(message.HasField("scan_report") for message in messages), 60)
        self.assertLess(len(messages), 100000, "the high-water mark")

    def test_two_subscribers_get_the_same(self):
        with self.daemon(BUSY, "--fast", "--wait-subscribers", 2, "--scans", 300) as daemon:
            first, second = daemon.stream(), daemon.stream()
            self.assertEqual(digest(first.to_the_end()), digest(second.to_the_end()))

    def test_clock_is_in_no_fast_run(self):
        for message in envelopes(self.published(BUSY, "--scans", 50)):
            self.assertFalse(message.HasField("status") and message.status.HasField("wall_clock"))

    def test_summary_is_the_same(self):
        path = self.path("busy.textproto")
        with open(path, "w", encoding="utf-8") as file:
            file.write(BUSY + f'stream {{ bind: "ipc://{self.path("s")}" }} control {{ bind: "ipc://{self.path("c")}" }}')
        outputs = {run("--config", path, "--fast", "--scans", "100")[:2] for _ in range(3)}
        self.assertEqual(len(outputs), 1)
        self.assertIn("100 scans of 1 s, policy sa_imm", outputs.pop()[1])


if __name__ == "__main__":
    unittest.main()
