"""A client that knows proto/ alone: it reads tracks, changes the policy, and sees the change at the promised scan."""

import unittest

import zmq

from daemon import BUSY, SystemTest
from dwell.v1 import control_pb2

PERIOD = "scan_period_s: 0.05\n"
POLICIES = ("round_robin", "fixed", "largest_variance", "sa_imm")


def set_policy(request_id, text):
    request = control_pb2.Request(id=request_id, client="python")
    request.set_policy.text = text
    return request


class PolicyClient(SystemTest):
    def until_scan(self, messages, scan, seen):
        for envelope in messages:
            seen.append(envelope)
            if envelope.HasField("scan_report") and envelope.scan_report.scan >= scan:
                return
        self.fail("the stream ended")

    def test_policy_changes_at_the_promised_scan_and_once(self):
        with self.daemon(PERIOD + BUSY, "--wait-subscribers", 1) as daemon:
            messages, control, seen = daemon.stream().messages(), daemon.control(), []
            self.until_scan(messages, 3, seen)
            tracks = {envelope.track.name: envelope.track for envelope in seen if envelope.HasField("track")}
            self.assertEqual(set(tracks), {"one", "two"})
            for track in tracks.values():
                self.assertEqual((len(track.state), len(track.covariance), len(track.mode_probability)), (4, 10, 3))
                self.assertAlmostEqual(sum(track.mode_probability), 1.0, delta=1e-12)

            request = set_policy("change-1", "round_robin:order=locked")
            reply = control.ask(request)
            promised = reply.accepted.effective_scan
            self.assertGreater(promised, 3)
            self.until_scan(messages, promised + 2, seen)
            again = control.ask(request)
            self.assertEqual(again, reply)
            self.until_scan(messages, seen[-1].scan_report.scan + 3, seen)

            self.assert_whole(seen)
            changes = [envelope.policy_change for envelope in seen if envelope.HasField("policy_change")]
            self.assertEqual(len(changes), 1)
            self.assertEqual(changes[0].scan, promised)
            self.assertEqual((changes[0].client, changes[0].request_id), ("python", "change-1"))
            self.assertEqual(getattr(changes[0], "from").WhichOneof("kind"), "sa_imm")
            self.assertEqual(changes[0].to.WhichOneof("kind"), "round_robin")
            for envelope in seen:
                if envelope.HasField("scan_report"):
                    report = envelope.scan_report
                    self.assertEqual(report.policy, "sa_imm" if report.scan < promised else "round_robin")

    def test_id_of_another_request_is_refused(self):
        with self.daemon(PERIOD + BUSY) as daemon:
            control = daemon.control()
            self.assertTrue(control.ask(set_policy("a", "fixed")).HasField("accepted"))
            refused = control.ask(set_policy("a", "sa_imm")).refused
            self.assertEqual(refused.reason, control_pb2.Refused.ID_REUSED)
            self.assertEqual(control.status().policy, "fixed:sensor=1")

    def test_unknown_policy_or_parameter_lists_the_valid_and_scanning_goes_on(self):
        with self.daemon(PERIOD + BUSY, "--wait-subscribers", 1) as daemon:
            messages, control, seen = daemon.stream().messages(), daemon.control(), []
            self.until_scan(messages, 2, seen)
            refused = control.ask(set_policy("a", "greedy")).refused
            self.assertEqual(refused.reason, control_pb2.Refused.INVALID)
            self.assertEqual((refused.violation[0].field, refused.violation[0].value), ("policy", "greedy"))
            for name in POLICIES:
                self.assertIn(name, refused.violation[0].rule)
            refused = control.ask(set_policy("b", "sa_imm:depth=2:cost=y")).refused
            self.assertEqual([violation.field for violation in refused.violation], ["sa_imm.depth", "sa_imm.cost"])
            self.assertIn("cost, beta, nodes", refused.violation[0].rule)
            self.assertIn("position, x, full, none", refused.violation[1].rule)
            self.until_scan(messages, seen[-1].scan_report.scan + 5, seen)
            self.assert_whole(seen)
            self.assertFalse([envelope for envelope in seen if envelope.HasField("policy_change")])
            self.assertEqual(control.status().wall_clock.requests_refused, 2)

    def test_every_policy_can_be_set(self):
        with self.daemon(PERIOD + BUSY, "--wait-subscribers", 1) as daemon:
            messages, control, seen = daemon.stream().messages(), daemon.control(), []
            entries = control.ask(list_policies={}).accepted.policy_list.entry
            self.assertLessEqual(set(POLICIES), {entry.name for entry in entries})
            for entry in entries:
                promised = control.ask(set_policy("set-" + entry.name, entry.name)).accepted.effective_scan
                self.until_scan(messages, promised, seen)
                self.assertEqual(seen[-1].scan_report.policy, entry.name)

    def test_request_of_a_req_socket_is_answered(self):
        with self.daemon(PERIOD + BUSY) as daemon:
            socket = daemon.context.socket(zmq.REQ)
            socket.linger = 0
            socket.connect(daemon.control_endpoint)
            for number in range(3):
                socket.send(control_pb2.Request(id=str(number), get_status=control_pb2.GetStatus()).SerializeToString())
                self.assertTrue(socket.poll(60000))
                self.assertEqual(control_pb2.Reply.FromString(socket.recv()).id, str(number))
            socket.close()


if __name__ == "__main__":
    unittest.main()
