"""The Python client against a daemon's two sockets. Run with PYTHONPATH=<build>/python."""

import threading
import unittest

import zmq

import dwell_client
from dwell.v1 import control_pb2, stream_pb2

CONTROL = "inproc://control"
STREAM = "inproc://stream"
PATIENCE_MS = 10_000


class Control(threading.Thread):
    """Reads requests until stop(); the first `deaf` get no answer, every later one gets answer(request)."""

    def __init__(self, context, answer, deaf=0):
        super().__init__(daemon=True)
        self.socket = context.socket(zmq.ROUTER)
        self.socket.bind(CONTROL)
        self.answer = answer
        self.deaf = deaf
        self.requests = []
        self.stopped = threading.Event()
        self.start()

    def run(self):
        while not self.stopped.is_set():
            if not self.socket.poll(10):
                continue
            peer, body = self.socket.recv_multipart()
            self.requests.append(control_pb2.Request.FromString(body))
            if len(self.requests) > self.deaf:
                self.socket.send_multipart([peer, self.answer(self.requests[-1]).SerializeToString()])
        self.socket.close(linger=PATIENCE_MS)

    def stop(self):
        self.stopped.set()
        self.join()


def accepted(request):
    return control_pb2.Reply(id=request.id, accepted=control_pb2.Accepted(effective_scan=43))


def refused(request):
    violation = control_pb2.Violation(field="nodes", value="99", rule="2 .. 32")
    return control_pb2.Reply(id=request.id, refused=control_pb2.Refused(
        reason=control_pb2.Refused.INVALID, violation=[violation]))


class Requests(unittest.TestCase):
    def setUp(self):
        self.context = zmq.Context()
        self.addCleanup(self.context.destroy, linger=0)

    def daemon(self, timeout_s, tries=3):
        return dwell_client.Dwell(CONTROL, STREAM, timeout_s=timeout_s, tries=tries, context=self.context)

    def serve(self, answer, deaf=0):
        control = Control(self.context, answer, deaf)
        self.addCleanup(control.stop)  # before the context goes: clean-ups run last in, first out
        return control

    def test_fields_reach_the_daemon(self):
        control = self.serve(accepted)
        daemon = self.daemon(PATIENCE_MS / 1000)
        self.assertEqual(daemon.request("set_radar", name="west", up=False).effective_scan, 43)
        daemon.request("pause")
        control.stop()
        self.assertEqual(control.requests[0].set_radar.name, "west")
        self.assertEqual(control.requests[1].WhichOneof("body"), "pause")
        self.assertNotEqual(control.requests[0].id, control.requests[1].id)

    def test_asks_again_with_the_same_id(self):
        control = self.serve(accepted, deaf=1)
        self.daemon(0.5, tries=100).request("pause")
        control.stop()
        self.assertGreater(len(control.requests), 1)
        self.assertEqual(control.requests[0], control.requests[1])

    def test_gives_up_after_the_last_try(self):
        control = self.serve(accepted, deaf=1000)
        with self.assertRaises(dwell_client.NoAnswer):
            self.daemon(0.05).request("pause")
        control.stop()
        self.assertEqual(len({request.id for request in control.requests}), 1)
        self.assertLessEqual(len(control.requests), 3)

    def test_a_refusal_names_its_violations(self):
        self.serve(refused)
        with self.assertRaisesRegex(dwell_client.Refused, "INVALID; nodes = 99: 2 .. 32"):
            self.daemon(PATIENCE_MS / 1000).request("set_policy", text="sa_imm:nodes=99")


class Envelopes(unittest.TestCase):
    def setUp(self):
        self.context = zmq.Context()
        self.addCleanup(self.context.destroy, linger=0)
        self.publisher = self.context.socket(zmq.XPUB)
        self.publisher.rcvtimeo = PATIENCE_MS
        self.publisher.bind(STREAM)
        self.daemon = dwell_client.Dwell(CONTROL, STREAM, context=self.context)

    def publish(self, topic, epoch, sequence, topic_sequence=0, **body):
        envelope = stream_pb2.Envelope(epoch=epoch, sequence=sequence, topic_sequence=topic_sequence, **body)
        self.publisher.send_multipart([topic.encode(), envelope.SerializeToString()])

    def read(self, subscriptions, publish, **arguments):
        """What the client yields, as (sequence, missed): published once the subscriptions have come."""
        got = []
        reader = threading.Thread(target=lambda: got.extend(
            (envelope.sequence, missed) for envelope, missed in
            self.daemon.envelopes(silence_s=PATIENCE_MS / 1000, **arguments)))
        reader.start()
        self.subscriptions = sorted(self.publisher.recv() for _ in range(subscriptions))
        publish()
        reader.join()
        return got

    def test_one_subscription_sees_holes_and_restarts(self):
        def publish():
            for sequence in (7, 8, 12):
                self.publish("status.", 1, sequence, status={})
            self.publish("status.", 2, 1, status={})
            self.publish("end.", 2, 2, end_of_stream={"reason": "done"})

        self.assertEqual(self.read(1, publish), [(7, 0), (8, 0), (12, 3), (1, 0), (2, 0)])
        self.assertEqual(self.subscriptions, [b"\x01"])
        self.assertEqual(self.daemon.restarts, 1)

    def test_a_reader_of_some_topics_counts_by_topic(self):
        def publish():
            self.publish("track.7.", 1, 1, 1, track={})
            self.publish("status.", 1, 2, 1, status={})
            self.publish("scan.", 1, 3, 1, scan_report={})
            self.publish("track.9.", 1, 9, 4, track={})
            self.publish("end.", 1, 10, 1, end_of_stream={})

        self.assertEqual(self.read(3, publish, topics=["track.", "scan."]), [(1, 0), (3, 0), (9, 2), (10, 0)])
        self.assertEqual(self.subscriptions, [b"\x01end.", b"\x01scan.", b"\x01track."])

    def test_silence_is_told(self):
        with self.assertRaises(dwell_client.NoData):
            next(self.daemon.envelopes(silence_s=0.01))


if __name__ == "__main__":
    unittest.main()
