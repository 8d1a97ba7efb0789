"""A child process that is given so much processor time, and what it tells meanwhile."""

from __future__ import annotations

import json
import os
import select
import signal
import time

POLL_S = 0.02
WALL_PER_PROCESSOR_TIME = 12
"""The machine is shared: a child may take so much longer by the wall clock before it is ended all the same."""


def watch(child: int, reading: int, limit_s: float, afterwards_s: float) -> dict:
    """Collects the JSON lines that `child` writes to the pipe `reading`. The first line must come within `limit_s` of
    processor time, the end within `afterwards_s` more; else the child is killed. Adds how the child ended: `outcome`
    is `timeout` or `crashed` unless the child told one, with `cpu_s` and `wall_s`."""
    started, written, killed, used = time.monotonic(), b"", False, 0.0
    while True:
        if select.select([reading], [], [], POLL_S)[0]:
            piece = os.read(reading, 1 << 16)
            if not piece:
                break
            written += piece
        used = processor_time(child) or used
        allowed = limit_s + (afterwards_s if b"\n" in written else 0.0)
        late = time.monotonic() - started > WALL_PER_PROCESSOR_TIME * allowed
        if not killed and (used > allowed or late):
            os.kill(child, signal.SIGKILL)
            killed = True
    os.close(reading)
    _, status = os.waitpid(child, 0)
    told: dict = {}
    for line in written.split(b"\n")[:-1]:
        told |= json.loads(line)
    if "outcome" not in told:
        number = os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0
        told["outcome"] = "timeout" if killed else "crashed"
        told["reason"] = signal.Signals(number).name if number else f"exit {os.WEXITSTATUS(status)}"
        told.setdefault("cpu_s", used)
        told.setdefault("wall_s", time.monotonic() - started)
    return told


def processor_time(process: int) -> float | None:
    """Seconds that the main thread has run, to the nanosecond (interval timers count ticks, and are off by a tenth on a
    busy core); None once it has ended."""
    try:
        with open(f"/proc/{process}/schedstat", encoding="ascii") as text:
            return int(text.read().split()[0]) / 1e9
    except (OSError, ValueError, IndexError):
        return None
