"""A controller of a UR arm as ur_rtde meets it: dashboard, script port and real-time data, on loopback.

A process of its own: ur_rtde keeps Python waiting while it connects.
"""

from __future__ import annotations

import json
import socket
import struct
import subprocess
import sys
import threading
import time
from functools import partial

KINDS = {
    **dict.fromkeys(("timestamp",), "d"),
    **dict.fromkeys(("actual_q",), "6d"),
    **dict.fromkeys(("robot_mode", "safety_mode"), "i"),
    **dict.fromkeys(("runtime_state", "robot_status_bits", "safety_status_bits"), "I"),
}
NAMES = {"d": "DOUBLE", "6d": "VECTOR6D", "i": "INT32", "I": "UINT32"}
SERVO, STOP_SERVO, STOP_SCRIPT = 11, 16, 255
READY, DONE = 1, 2


def kind(name):
    """Return how a variable is packed; registers by their names."""
    return KINDS.get(name, "i" if "_int_register_" in name else "d")


class FakeArm:
    """An arm that is where it was last told to be; `fails_after` bytes of data sent, its network is gone."""

    def __init__(self, q, model="UR5", safety=1, mode=7, fails_after=None, lags=0.0):
        self.q, self.model, self.safety, self.mode = list(q), model, safety, mode
        self.fails_after, self.lags = fails_after, lags
        self.commands, self.places, self.running, self.state = [], [], False, READY
        self._sent, self._open, self._listening = 0, [], []
        for port, talk in ((29999, self._dashboard), (30003, self._script), (30004, self._data)):
            listening = socket.socket()
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listening.bind(("127.0.0.1", port))
            listening.listen()
            self._listening.append(listening)
            threading.Thread(target=self._accept, args=(listening, talk), daemon=True).start()

    def _accept(self, listening, talk):
        while True:
            try:
                connection, _ = listening.accept()
            except OSError:
                return
            self._open.append(connection)
            threading.Thread(target=self._until_lost, args=(talk, connection), daemon=True).start()

    def _until_lost(self, talk, connection):
        try:
            talk(connection)
        except (OSError, EOFError):
            pass
        finally:
            connection.close()

    def _send(self, connection, data):
        if self.fails_after is not None:
            left = self.fails_after - self._sent
            data, gone = data[: max(left, 0)], left <= len(data)
            self._sent += len(data)
            connection.sendall(data)
            if gone:
                raise EOFError
            return
        connection.sendall(data)

    def _dashboard(self, connection):
        self._send(connection, b"Connected: Universal Robots Dashboard Server\n")
        answers = {
            "PolyscopeVersion": "URSoftware 5.11.0.108249 (Mar 25 2021)",
            "get serial number": "2019550001",
            "get robot model": self.model,
            "is in remote control": "true",
        }
        while asked := connection.recv(4096):
            self._send(connection, (answers.get(asked.decode().strip(), "ok") + "\n").encode())

    def _script(self, connection):
        while connection.recv(65536):
            self.running = True

    def _data(self, connection):
        lock, asked = threading.Lock(), ([], 125.0)

        def answer(letter, body):
            with lock:
                self._send(connection, struct.pack(">HB", 3 + len(body), ord(letter)) + body)

        recipes = 0
        while True:
            size, letter = struct.unpack(">HB", _exactly(connection, 3))
            body, letter = _exactly(connection, size - 3), chr(letter)
            if letter == "v":
                answer("v", struct.pack(">IIII", 5, 11, 0, 1))
            elif letter == "O":
                names = [name for name in body[8:].decode().split(",") if name]
                asked = names, struct.unpack(">d", body[:8])[0]
                answer("O", b"\x01" + ",".join(NAMES[kind(name)] for name in names).encode())
            elif letter == "I":
                recipes += 1
                answer("I", bytes([recipes]) + b"OK")
            elif letter == "U":
                self._obey(body)
            else:
                answer(letter, b"\x01")
            if letter == "S":
                talk = partial(self._stream, answer, *asked)
                threading.Thread(target=self._until_lost, args=(talk, connection), daemon=True).start()

    def _obey(self, body):
        command = struct.unpack(">i", body[1:5])[0]
        self.commands.append(command)
        self.running = self.running and command != STOP_SCRIPT
        # Ready, or done with a command that is waited for.
        self.state = READY if command in (0, SERVO) else DONE
        if command == SERVO:
            self.places.append(struct.unpack(">6d", body[5:53]))
            if not self.lags:
                self.q = list(self.places[-1])

    def _stream(self, answer, names, rate, _):
        began = time.time()
        while True:
            values = {
                "timestamp": time.time() - began,
                "robot_mode": self.mode,
                "safety_mode": self.safety,
                "runtime_state": 2 if self.running else 1,
                "robot_status_bits": 3 if self.running else 1,
                "safety_status_bits": 1,
                "output_int_register_0": self.state if self.running else 0,
            }
            body = b"\x01"
            for name in names:
                numbers = self.q if name == "actual_q" else [values.get(name, 0)]
                body += struct.pack(">" + kind(name), *numbers)
            answer("U", body)
            time.sleep(1.0 / rate)


def _exactly(connection, count):
    data = b""
    while len(data) < count:
        part = connection.recv(count - len(data))
        if not part:
            raise EOFError
        data += part
    return data


class ArmElsewhere:
    """A `FakeArm` in a process of its own."""

    def __init__(self, **options):
        command = [sys.executable, "-m", "tests_peers.fake_ur", json.dumps(options)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        assert self._process.stdout.readline() == "listening\n"

    def told(self):
        """Return the commands that came, and the places that it was told to go to."""
        self._process.stdin.write("report\n")
        self._process.stdin.flush()
        return json.loads(self._process.stdout.readline())

    def close(self):
        """End it."""
        self._process.kill()
        self._process.communicate()


def main():
    """Be an arm until standard input ends; say what came for each line of it."""
    arm = FakeArm(**json.loads(sys.argv[1]))
    print("listening", flush=True)
    for _ in sys.stdin:
        print(json.dumps([arm.commands, arm.places]), flush=True)


if __name__ == "__main__":
    main()
