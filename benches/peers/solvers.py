"""Both planners as processes: HPP behind one server per scene, Foliate one process per solve."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from importlib import metadata
from pathlib import Path

HERE = Path(__file__).resolve().parent
SCENES_FOLDER = HERE.parents[1] / "scenes"
FOLIATE_LIMIT_S = 60.0
MEMORY_BYTES = 8 << 30


class SolverError(Exception):
    """A planner that cannot be started at all; the message tells what it said."""


def scene_file(scene: str) -> Path:
    return SCENES_FOLDER / scene / "scene.toml"


class HppServer:
    """`hpp_server.py` for one scene; `close` it before another one is started."""

    def __init__(self, scene: str):
        # Addresses are part of what HPP decides by (connected components in pointer order), and its graph factory
        # goes through sets of strings; without `setarch -R` and a fixed hash seed the same seed is another search.
        command = ["setarch", "-R", sys.executable, str(HERE / "hpp_server.py"), str(scene_file(scene))]
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=hpp_environment(), text=True
        )
        self.ready = self._read()
        if "error" in self.ready:
            self.close()
            raise SolverError(f"{scene}: {self.ready['error']}")

    def solve(self, solver: str, seed: int, limit_s: float, answer: Path) -> dict:
        """What the server tells of one solve."""
        request = {"solver": solver, "seed": seed, "limit_s": limit_s, "answer": str(answer)}
        self.process.stdin.write(json.dumps(request) + "\n")
        self.process.stdin.flush()
        return self._read()

    def close(self) -> None:
        self.process.stdin.close()
        self.process.wait(timeout=60)

    def _read(self) -> dict:
        line = self.process.stdout.readline()
        if not line:
            raise SolverError(f"the server of HPP ended, status {self.process.wait(timeout=60)}")
        return json.loads(line)


def hpp_environment() -> dict[str, str]:
    """HPP's wheels have no run path, and its models are found through ROS's variable."""
    prefix = cmeel_prefix()
    threads = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
    libraries = os.pathsep.join(filter(None, [str(prefix / "lib"), os.environ.get("LD_LIBRARY_PATH")]))
    return os.environ | threads | {
        "LD_LIBRARY_PATH": libraries,
        "ROS_PACKAGE_PATH": str(prefix / "share"),
        "PYTHONHASHSEED": "0",
    }


def cmeel_prefix() -> Path:
    for folder in sys.path:
        prefix = Path(folder) / "cmeel.prefix"
        if (prefix / "lib").is_dir():
            return prefix
    raise SolverError("no cmeel.prefix on Python's path: pip install hpp-python (README.md)")


def hpp_version() -> str:
    return f"hpp-python {metadata.version('hpp-python')}"


def foliate_version(program: Path, commit: str) -> str:
    told = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    return f"{told} {commit}".strip()


def solve_with_foliate(program: Path, scene: str, seed: int, answer: Path, options: list | None = None) -> dict:
    """One process of `foliate solve` with default settings, or `options` besides: what it tells, and the process's own
    times."""
    answer.parent.mkdir(parents=True, exist_ok=True)
    command = [program, "solve", scene_file(scene), "--seed", seed, "--threads", 1, "--time-limit", FOLIATE_LIMIT_S,
               "--json", "--out", answer, *(options or [])]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        [str(word) for word in command], capture_output=True, text=True, check=False, preexec_fn=_cap_memory
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    try:
        told = json.loads(done.stdout)
    except json.JSONDecodeError:
        return {"outcome": "crashed", "reason": done.stderr.strip()[-300:], "cpu_s": cpu, "status": done.returncode}
    return {**told, "cpu_s": cpu, "status": done.returncode}


def _cap_memory() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
