"""Programs of ours in processes of their own, ended in every way that a process can end."""

from __future__ import annotations

import fcntl
import json
import os
import pty
import re
import signal
import subprocess
import sys
import termios
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from select import select
from typing import Any

from tests.waiting import wait_until
from venus3d.storage.camera_yaml import read_camera_yaml

PATIENCE_S = 300


def wait_until_there(path: Path) -> None:
    """Fails if such a file does not come."""
    wait_until(path.exists, f"{path} comes", PATIENCE_S)


class Program:
    """`tests.cli.watched`, whose output is read line by line."""

    def __init__(self, *arguments: str, prefix: tuple[str, ...] = (), **more: str) -> None:
        """Run it with these arguments, after `prefix`, with `more` in its environment."""
        self.process = subprocess.Popen(
            [*prefix, sys.executable, "-m", "tests.cli.watched", *arguments],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, **more},
        )
        self._complaints = ""
        # Whoever waits for a line in vain must hear of it.
        self._end = threading.Timer(PATIENCE_S, self.process.kill)
        self._end.start()

    def wait_for(self, pattern: str) -> re.Match[str]:
        """The next line with this in it."""
        assert self.process.stdout is not None
        for line in self.process.stdout:
            if found := re.search(pattern, line):
                return found
        raise AssertionError((pattern, self.process.communicate()[1]))

    def wait_for_views(self, count: int) -> int:
        """How many views there are once there are at least so many."""
        while (views := int(self.wait_for(r"^views (\d+)")[1])) < count:
            pass
        return views

    def send(self, *blows: signal.Signals) -> None:
        """Send these signals, a tenth of a second after each other, while it runs."""
        for blow in blows:
            self.process.send_signal(blow)  # does nothing once it has ended and was waited for
            with suppress(subprocess.TimeoutExpired):
                self.process.wait(0.1)

    @contextmanager
    def standing_still(self) -> Iterator[None]:
        """Stopped meanwhile: on the disk is what a kill at this moment would leave there."""
        self.process.send_signal(signal.SIGSTOP)
        _, status = os.waitpid(self.process.pid, os.WUNTRACED)
        assert os.WIFSTOPPED(status), status
        yield
        self.process.send_signal(signal.SIGCONT)

    def complaints(self) -> str:
        """What it has written to stderr until now; `ended` then gives what comes later."""
        assert self.process.stderr is not None
        while select([self.process.stderr], [], [], 0)[0]:
            if not (more := os.read(self.process.stderr.fileno(), 65536)):
                break
            self._complaints += more.decode()
        return self._complaints

    def ended(self) -> tuple[int, str, str]:
        """Exit code and the rest of both streams."""
        out, err = self.process.communicate(timeout=PATIENCE_S)
        return self.process.returncode, out, err

    def kill(self) -> None:
        """Without a chance to say or keep anything."""
        self.process.kill()
        self.process.communicate()
        self._end.cancel()


class OnATerminal:
    """The same with a terminal of its own, which can be closed."""

    def __init__(self, *arguments: str, log: Path) -> None:
        """Run it with these arguments; stderr goes into `log`, where it can be read afterwards."""
        self._master, slave = pty.openpty()
        with log.open("wb") as errors:
            self.process = subprocess.Popen(
                [sys.executable, "-m", "tests.cli.watched", *arguments],
                stdin=slave,
                stdout=slave,
                stderr=errors,
                start_new_session=True,
                preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0),
            )
        os.close(slave)
        self._end = threading.Timer(PATIENCE_S, self.process.kill)
        self._end.start()

    def wait_for_views(self, count: int) -> None:
        """Read what it prints until there are so many views."""
        text = b""
        while not re.search(rb"views %d\r\n" % count, text):
            text += os.read(self._master, 4096)

    def close_terminal(self) -> None:
        """As when its window is closed."""
        os.close(self._master)

    def kill(self) -> None:
        """Without a chance to say or keep anything."""
        self.process.kill()
        self.process.wait()
        self._end.cancel()


def kept(folder: Path) -> dict[str, Any]:
    """The result in a folder, complete and of one piece, and only the session beside it."""
    result: dict[str, Any] = json.loads((folder / "result.json").read_text())
    assert len(result["captured"]) == result["views"] == result["history"][-1]["views"]
    camera = read_camera_yaml(folder / "camera.yaml")
    assert [camera.fx, camera.cy] == [result["intrinsics"]["fx"], result["intrinsics"]["cy"]]
    of_the_session = {"session.json", "events.jsonl", "views", ".lock"}
    names = {path.name for path in folder.iterdir()}
    assert names - of_the_session == {"camera.yaml", "result.json"}
    return result
