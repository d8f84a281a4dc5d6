"""Flags, bad input and exit codes: 0 done, 1 failed while running, 2 bad command line, 78 bad config."""

import glob
import os
import socket
import unittest

from daemon import BUSY, SCENARIOS, SystemTest, run


class CommandLine(SystemTest):
    def write(self, text):
        path = self.path("config.textproto")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def ipc(self, text=BUSY):
        return self.write(text + f'\nstream {{ bind: "ipc://{self.path("s")}" }} control {{ bind: "ipc://{self.path("c")}" }}')

    def test_done_is_0(self):
        self.assertEqual(run("--config", self.ipc(), "--fast", "--scans", "3")[0], 0)
        code, output, _ = run("--help")
        self.assertEqual(code, 0)
        for flag in ("--config", "--fast", "--scans", "--seed", "--wait-subscribers", "--check-config", "--record",
                     "--replay"):
            self.assertIn(flag, output)

    def test_bad_command_line_is_2(self):
        config = self.ipc()
        for arguments in ((), ("--unknown",), ("--config",), ("--config", config, "--scans", "0"),
                          ("--config", config, "--scans", "-1"), ("--config", config, "--scans", "many"),
                          ("--config", config, "--scans", "1.5"), ("--config", config, "--seed", "-1"),
                          ("--config", config, "--wait-subscribers", "-1"), ("--config", config, "rest"),
                          ("--replay", "journal", "--config", config), ("--replay", "journal", "--seed", "1"),
                          ("--replay", "journal", "--record", "other"), ("--replay", "journal", "--fast")):
            code, output, errors = run(*arguments)
            self.assertEqual(code, 2, arguments)
            self.assertTrue(errors, arguments)
            self.assertFalse(output, arguments)

    def test_syntax_error_is_78_with_line_and_column(self):
        path = self.write('seed: 1\nradar { name "west" }\n')
        code, output, errors = run("--config", path)
        self.assertEqual(code, 78)
        self.assertIn(f'{path}:2:14: syntax: Expected ":"', errors)
        self.assertFalse(output)

    def test_all_that_is_wrong_is_listed_at_once(self):
        path = self.write('scan_period_s: nan\n'
                          'radar { name: "r" beamwidth_deg: 91 }\n'
                          'radar { name: "r" }\n'
                          'target { name: "t" recording { file: "none.csv" } }\n'
                          'policy { fixed { sensor: 9 } }\n')
        code, _, errors = run("--config", path, "--check-config")
        self.assertEqual(code, 78)
        self.assertEqual(errors.splitlines(), [
            f"{path}:1:1: scan_period_s = nan: must be in [0.001, 3600]",
            f"{path}:2:19: radar[1].beamwidth_deg = 91: must be in (0, 90]",
            f'{path}:3:9: radar[2].name = "r": must be unique among the sensors',
            f'{path}:4:32: target[1].recording.file = "none.csv": cannot be read: {self.path("none.csv")}',
            f"{path}:5:18: policy.fixed.sensor = 9: must be a whole number from 1 to 2"])

    def test_missing_config_is_78(self):
        for path in (self.path("none.textproto"), self.directory):
            code, _, errors = run("--config", path)
            self.assertEqual(code, 78)
            self.assertIn(f"{path}: file: cannot be read", errors)

    def test_port_in_use_is_1_and_named(self):
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            taken.listen()
            endpoint = "tcp://127.0.0.1:%d" % taken.getsockname()[1]
            for port, other in (("stream", "control"), ("control", "stream")):
                path = self.write(BUSY + f'{port} {{ bind: "{endpoint}" }} {other} {{ bind: "ipc://{self.path("o")}" }}')
                code, _, errors = run("--config", path)
                self.assertEqual(code, 1)
                self.assertIn(endpoint, errors)
                self.assertIn("is another dwelld running?", errors)

    def test_endpoint_beyond_this_machine_is_78(self):
        code, _, errors = run("--config", self.write(BUSY + 'control { bind: "tcp://0.0.0.0:5557" }'))
        self.assertEqual(code, 78)
        self.assertIn("there is no authentication", errors)

    def test_effective_config_is_a_config_with_the_same_effective_config(self):
        configs = glob.glob(os.path.join(SCENARIOS, "*.textproto"))
        self.assertGreaterEqual(len(configs), 4)
        for config in configs:
            code, effective, errors = run("--config", config, "--check-config")
            self.assertEqual((code, errors), (0, ""), config)
            # Recordings are looked for beside the config.
            copy = os.path.join(self.directory, os.path.basename(config))
            with open(copy, "w", encoding="utf-8") as file:
                file.write(effective)
            flights = self.path("flights")
            if not os.path.lexists(flights):
                os.symlink(os.path.join(SCENARIOS, "flights"), flights)
            self.assertEqual(run("--config", copy, "--check-config"), (0, effective, ""), config)

    def test_check_config_shows_the_seed_of_the_command_line(self):
        self.assertIn("\nseed: 99\n", run("--config", self.ipc(), "--seed", "99", "--check-config")[1])

    def test_journal_that_cannot_be_made_is_1(self):
        config = self.ipc()
        for journal in (config, self.path("no/such/directory")):
            code, _, errors = run("--config", config, "--fast", "--scans", "1", "--record", journal)
            self.assertEqual(code, 1)
            self.assertIn(journal, errors)
        with open(config, encoding="utf-8") as file:
            self.assertTrue(file.read().startswith(BUSY), "the file that was there is left alone")


if __name__ == "__main__":
    unittest.main()
