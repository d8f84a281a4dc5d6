"""A client of dwelld in Python: commands, and the stream with its gaps.

Written from the schema in proto/ alone. The build makes the message classes; from the repository:

    PYTHONPATH=build/release/python python3
    >>> import dwell_client
    >>> daemon = dwell_client.Dwell()
    >>> daemon.request("get_status").status.scan
    412
    >>> daemon.request("set_policy", text="sa_imm:cost=x").effective_scan
    418
    >>> for envelope, missed in daemon.envelopes():
    ...     if missed:
    ...         print("missed", missed, "messages")
    ...     if envelope.WhichOneof("body") == "track":
    ...         print(envelope.track.id, list(envelope.track.state))

Needs python3-zmq and python3-protobuf. One Dwell belongs to one thread.
"""

import secrets
import time

import zmq

from dwell.v1 import control_pb2, stream_pb2

TOPICS = ("track.", "scan.", "plot.", "status.", "policy.", "radar.", "end.")


class NoAnswer(Exception):
    """The daemon did not answer the last try either."""


class NoData(Exception):
    """The stream was silent for longer than asked for. It carries a status every second: silence means a fault."""


class Refused(Exception):
    """The daemon refused; `reply` is its control_pb2.Refused with the violations."""

    def __init__(self, reply):
        rules = [f"{v.field} = {v.value}: {v.rule}" for v in reply.violation]
        super().__init__("; ".join([control_pb2.Refused.Reason.Name(reply.reason)] + rules))
        self.reply = reply


class Dwell:
    """A daemon, by its two endpoints. Sockets are made when they are first needed."""

    def __init__(self, control="tcp://127.0.0.1:5557", stream="tcp://127.0.0.1:5556", client="dwell_client.py",
                 timeout_s=2.0, tries=3, context=None):
        self.control = control
        self.stream = stream
        self.client = client
        self.timeout_s = timeout_s
        self.tries = tries
        self.context = context or zmq.Context.instance()
        self.epoch = None  # of the last envelope
        self.restarts = 0  # of the daemon, seen by envelopes()

    def request(self, command, **fields):
        """Sends one command, named as in Request.body, and returns the daemon's control_pb2.Accepted.

        The fields are those of the command's message: request("set_radar", name="west", up=False). While no answer
        comes the request is sent again, `tries` times in all, with the SAME id and on a new socket (the Lazy Pirate
        of the ZeroMQ guide): the daemon applies an id once. Raises Refused or NoAnswer.
        """
        request = control_pb2.Request(id=secrets.token_hex(16), client=self.client)
        body = getattr(request, command)
        body.SetInParent()  # a command without fields is a command all the same
        body.MergeFrom(type(body)(**fields))
        for _ in range(self.tries):
            with self.context.socket(zmq.DEALER) as socket:
                socket.setsockopt(zmq.LINGER, 0)
                socket.connect(self.control)
                socket.send(request.SerializeToString())
                reply = self._await_reply(socket, request.id)
            if reply is not None and reply.HasField("refused"):
                raise Refused(reply.refused)
            if reply is not None:
                return reply.accepted
        raise NoAnswer(f"no answer from {self.control}: is dwelld running there?")

    def _await_reply(self, socket, request_id):
        deadline = time.monotonic() + self.timeout_s
        while (left_s := deadline - time.monotonic()) > 0:
            if not socket.poll(left_s * 1000):
                return None
            reply = control_pb2.Reply.FromString(socket.recv_multipart()[-1])
            # A daemon that could not read the request cannot know its id.
            if reply.id == request_id or (not reply.id and reply.HasField("refused")):
                return reply
        return None

    def envelopes(self, topics=None, silence_s=None):
        """Subscribes, and yields (stream_pb2.Envelope, missed) until EndOfStream, which is the last it yields.

        missed: how many messages were lost just before this one, by the sequence numbers. 0 for the first, and for
        the first of a daemon that has restarted (then `restarts` goes up, and what you knew is void: get_snapshot).
        topics: some of TOPICS, for those who want no more; the end always comes along. By default everything, with
        ONE subscription. silence_s: raises NoData when the stream is silent for so long; by default waits for ever.

        The subscription begins with the first next(). To join without a hole: take the first envelope, then
        request("get_snapshot"), and skip the envelopes whose sequence is at or below the snapshot's.
        """
        with self.context.socket(zmq.SUB) as socket:
            socket.setsockopt(zmq.LINGER, 0)
            socket.setsockopt(zmq.RCVHWM, 100_000)
            socket.setsockopt(zmq.HEARTBEAT_IVL, 2000)
            socket.setsockopt(zmq.HEARTBEAT_TIMEOUT, 6000)
            for topic in set(topics) | {"end."} if topics else {""}:
                socket.setsockopt_string(zmq.SUBSCRIBE, topic)
            socket.connect(self.stream)
            expected = {}  # the next number: of the stream, or of each topic where only some are read
            while True:
                if not socket.poll(None if silence_s is None else silence_s * 1000):
                    raise NoData(f"no data from {self.stream} for {silence_s} s")
                topic, payload = socket.recv_multipart()
                envelope = stream_pb2.Envelope.FromString(payload)
                if self.epoch is not None and envelope.epoch != self.epoch:
                    self.restarts += 1
                    expected = {}
                self.epoch = envelope.epoch
                counter = topic.split(b".")[0] if topics else b""
                number = envelope.topic_sequence if topics else envelope.sequence
                missed = max(number - expected.get(counter, number), 0)
                expected[counter] = number + 1
                yield envelope, missed
                if envelope.HasField("end_of_stream"):
                    return
