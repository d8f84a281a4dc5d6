"""A journal repeats its run, byte for byte."""

import os
import unittest

from daemon import BUSY, Daemon, Ended, SystemTest, run, scaled, scenario, signal, without_epoch
from dwell.v1 import control_pb2, stream_pb2

SCANS = scaled(3000)
HIGH_WATER_MARK = 10_000_000  # all of a run: no reader is as fast as a fast run


class Replay(SystemTest):
    def recorded(self, journal, scans, after_first_message):
        """A fast run with commands in the middle: what it published."""
        with self.daemon(BUSY, "--fast", "--wait-subscribers", 1, "--scans", scans, "--record", journal,
                         high_water_mark=HIGH_WATER_MARK) as daemon:
            stream, control = daemon.stream(), daemon.control()
            topic, first = stream.receive()
            after_first_message(control)
            messages = [(topic, without_epoch(first)), *stream.to_the_end()]
            self.assertEqual(daemon.wait(), 0, daemon.log)
        return messages

    def replayed(self, journal, *arguments):
        with Daemon(self.directory, None, "--replay", journal, "--wait-subscribers", 1, *arguments) as daemon:
            messages = daemon.stream().to_the_end()
            self.assertEqual(daemon.wait(), 0, daemon.log)
        return messages

    def test_run_with_classes_is_repeated_byte_for_byte(self):
        journal = self.path("journal")
        with self.daemon(scenario("identification"), "--fast", "--wait-subscribers", 1, "--scans", 100, "--record",
                         journal, high_water_mark=HIGH_WATER_MARK) as daemon:
            original = daemon.stream().to_the_end()
            self.assertEqual(daemon.wait(), 0, daemon.log)
        beliefs = [track.class_belief for track in map(self.track, original) if track.class_belief]
        self.assertGreaterEqual(len(beliefs), 6 * 100)
        self.assertEqual(self.replayed(journal), original)

    @staticmethod
    def track(message):
        return stream_pb2.Envelope.FromString(message[1]).track

    def commands(self, control):
        request = control_pb2.Request(id="policy", client="test")
        request.set_policy.text = "round_robin:order=track_fastest"
        scans = [control.ask(request).accepted.effective_scan]
        scans.append(control.ask(set_radar={"name": "west", "up": False}).accepted.effective_scan)
        control.ask(request)
        request = control_pb2.Request(id="back", client="test")
        request.set_policy.text = "sa_imm"
        scans.append(control.ask(request).accepted.effective_scan)
        scans.append(control.ask(set_radar={"name": "west", "up": True}).accepted.effective_scan)
        self.scans = scans

    def recorded_with_commands(self, journal, scans):
        """The run is as long as the commands need on a busy machine: a run that ended first is made anew, longer."""
        try:
            return self.recorded(journal, scans, self.commands), scans
        except Ended:
            os.remove(journal)
            return self.recorded_with_commands(journal, 10 * scans)

    def test_run_with_commands_is_repeated_byte_for_byte(self):
        journal = self.path("journal")
        original, scans = self.recorded_with_commands(journal, SCANS)
        self.assertEqual(sum(topic in (b"policy.", b"radar.") for topic, _ in original), 4)
        self.assertTrue(1 < self.scans[0] <= self.scans[-1] <= scans, self.scans)
        print("commands took effect at scans", *self.scans, flush=True)
        self.assertEqual(self.replayed(journal), original)
        shorter = self.replayed(journal, "--scans", self.scans[-1] + 5)
        self.assertEqual(shorter[:-1], original[:len(shorter) - 1])

    def test_run_that_was_stopped_is_repeated_to_its_last_message(self):
        journal = self.path("journal")

        def command_and_stop(control):
            self.commands(control)
            control.ask(set_radar={"name": "south", "up": False})
            control.ask(stop={})

        original = self.recorded(journal, 1000 * SCANS, command_and_stop)
        self.assertEqual(self.replayed(journal), original)
        last = stream_pb2.Envelope.FromString(original[-1][1])
        self.assertEqual(last.end_of_stream.reason, "stopped by test")

    def test_run_that_was_killed_is_repeated_up_to_what_was_seen(self):
        journal = self.path("journal")
        with self.daemon(BUSY, "--fast", "--wait-subscribers", 1, "--record", journal,
                         high_water_mark=HIGH_WATER_MARK) as daemon:
            stream, control = daemon.stream(), daemon.control()
            topic, first = stream.receive()
            self.commands(control)
            seen = [(topic, without_epoch(first))]
            scan = 0
            while scan < self.scans[-1] + 20:
                topic, envelope = stream.receive()
                seen.append((topic, without_epoch(envelope)))
                if topic == b"scan.":
                    scan = stream_pb2.Envelope.FromString(envelope).scan_report.scan
            daemon.signal(signal.SIGKILL)
            self.assertEqual(daemon.wait(), -signal.SIGKILL)
        code, _, errors = run("--replay", journal)
        self.assertEqual(code, 78)
        self.assertIn("--scans", errors)
        again = self.replayed(journal, "--scans", scan)
        self.assertEqual(again[:len(seen)], seen)

    def test_replay_refuses_changes_but_answers(self):
        journal = self.path("journal")
        self.recorded(journal, 50, lambda control: None)
        with Daemon(self.directory, None, "--replay", journal, "--wait-subscribers", 1) as daemon:
            control = daemon.control()
            refused = control.ask(set_radar={"name": "west", "up": False}).refused
            self.assertEqual(refused.reason, control_pb2.Refused.NOT_NOW)
            self.assertEqual(control.status().scan, 0)

    def test_journal_that_is_damaged_is_78_with_its_place(self):
        journal = self.path("journal")
        self.recorded(journal, 50, lambda control: None)
        with open(journal, "r+b") as file:
            file.seek(100)
            byte = file.read(1)[0]
            file.seek(100)
            file.write(bytes([byte ^ 0x10]))
        code, _, errors = run("--replay", journal)
        self.assertEqual(code, 78)
        self.assertIn(f"{journal}: record = at byte 0: is damaged or cut off", errors)
        self.assertEqual(run("--replay", self.path("none"))[0], 78)

    def test_recordings_are_found_from_elsewhere(self):
        journal = self.path("journal")
        csv = self.path("f.csv")
        with open(csv, "w", encoding="utf-8") as file:
            file.write("time_s,lat,lon,alt_m,id\n" + "".join(f"{10 * i},52.{i:02},5,3000,a\n" for i in range(50)))
        config = 'radar { name: "r" y_m: -50e3 } target { name: "t" recording { file: "f.csv" repeat: true } }\n'
        with self.daemon(config, "--fast", "--wait-subscribers", 1, "--scans", 600, "--record", journal) as daemon:
            original = daemon.stream().to_the_end()
            self.assertEqual(daemon.wait(), 0, daemon.log)
        before = os.getcwd()
        os.chdir("/")
        try:
            self.assertEqual(self.replayed(journal), original)
        finally:
            os.chdir(before)


if __name__ == "__main__":
    unittest.main()
