"""Plays a path in the browser by viser (``pip install viser``)."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from foliate._foliate import Path, Scene

__all__ = ["Player", "play"]

GREY = (0.7, 0.7, 0.7, 1.0)


class Player:
    """A path in a viser server: a frame for each link, with its solids, and a slider for the time."""

    def __init__(self, path: Path, scene: Scene, server: Any, *, rate: float = 30.0) -> None:
        self.server = server
        """The ``viser.ViserServer``."""
        self.times = path.times(rate)
        """Seconds: shape (times,)."""
        solids = scene.solids(visual=True)
        links = sorted({solid.link for solid in solids})
        self._poses = path.poses(links, self.times)
        self._frames = [server.scene.add_frame(f"/{link}", show_axes=False) for link in links]
        for number, solid in enumerate(solids):
            *color, opacity = solid.color or GREY
            pose = np.asarray(solid.pose)
            server.scene.add_mesh_simple(
                f"/{solid.link}/solid_{number}",
                vertices=solid.vertices,
                faces=solid.triangles,
                color=tuple(color),
                opacity=None if opacity >= 1.0 else opacity,
                position=pose[:3],
                wxyz=pose[[6, 3, 4, 5]],
            )
        begin, end = float(self.times[0]), float(self.times[-1])
        self._slider = server.gui.add_slider("time (s)", min=begin, max=end, step=max((end - begin) / 1000, 1e-3), initial_value=begin)
        self._slider.on_update(lambda _: self.show(float(self._slider.value)))
        self.show(begin)

    def show(self, moment: float) -> None:
        """Shows the path at a time, seconds."""
        index = int(np.clip(np.searchsorted(self.times, moment), 0, self.times.size - 1))
        for frame, pose in zip(self._frames, self._poses[index], strict=True):
            frame.position = pose[:3]
            frame.wxyz = pose[[6, 3, 4, 5]]

    def run(self, speed: float = 1.0) -> None:
        """Plays from the beginning to the end; returns then."""
        begin, end = float(self.times[0]), float(self.times[-1])
        started = time.monotonic()
        while (moment := begin + speed * (time.monotonic() - started)) < end:
            self._slider.value = moment
            self.show(moment)
            time.sleep(1 / 60)
        self._slider.value = end
        self.show(end)


def play(path: Path, scene: Scene, *, server: Any = None, rate: float = 30.0, port: int = 8080) -> Player:
    """Shows a path in a viser server (a new one at ``port``, if none is given) and plays it in the background. The slider goes to any time."""
    if server is None:
        import viser

        server = viser.ViserServer(port=port)
    player = Player(path, scene, server, rate=rate)
    threading.Thread(target=player.run, daemon=True, name="foliate-viser").start()
    return player
