"""A whole guided calibration in a loop of one's own: source, detector, session, simulated hand."""

from __future__ import annotations

import sys

from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.board import Board
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.work import Settings
from venus3d.engine.planning.costs import projection_diff_px
from venus3d.sources.sim import Simulation


def main(max_views: str = "4") -> None:
    board = Board()
    source = Simulation(board=board, seed=0, fps=5, speed=2.5)
    detector = Detector(board)
    session = Session(board, source.image_size, Settings(max_views=int(max_views)))

    snapshot = session.snapshot()
    headline = ""
    while snapshot.phase not in ("converged", "finished"):
        frame = source.read()
        assert frame is not None
        snapshot = session.observe(detector.detect(frame.image, time_s=frame.time_s))
        # Calibrating and searching take time; here they may, elsewhere they get their own thread.
        while session.pending is not None:
            snapshot = session.apply(session.pending.run())
            views, fx = len(snapshot.views), snapshot.camera.fx
            print(f"{frame.time_s:5.1f} s  {views} views: fx {fx:.1f} px")
        if snapshot.headline != headline:
            headline = snapshot.headline
            print(f"{frame.time_s:5.1f} s  {headline}: {snapshot.instruction.camera}")
        source.follow(snapshot.target, snapshot.pose)

    error = projection_diff_px(source.truth, snapshot.camera)
    print(f"{snapshot.phase} after {len(snapshot.views)} views, {error:.3f} px from the truth")
    source.close()


if __name__ == "__main__":
    main(*sys.argv[1:])
