"""Boards that look the same after a turn: another numbering of the same points is as true.

A picture does not tell which of them it is; what was seen before does, or where the board is meant
to be. For calibrating it does not matter.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Pose, turn

_TURN = np.array([[0, 1], [-1, 0]])  # of columns (x, y), by a quarter turn about -z


def turned_pose(pose: Pose, quarters: int) -> Pose:
    """The pose of a board that is read as turned back by quarter turns about its z axis."""
    return Pose(pose.R @ turn("z", 90.0 * quarters), pose.t)


def renumbered(board: Board, seen: Observation, quarters: int) -> Observation:
    """The observation that has `turned_pose`, if the board looks as it did before after so many
    quarter turns: the same points under other ids."""
    if quarters % 4 == 0 or seen.count == 0:
        return seen
    places = 2 * board.lattice - board.lattice.max(axis=0)  # about the middle
    turned = places @ np.linalg.matrix_power(_TURN, quarters % 4).T
    new_ids = {(x, y): number for number, (x, y) in enumerate(places.tolist())}
    ids = np.array([new_ids[x, y] for x, y in turned[seen.ids].tolist()], dtype=np.intp)
    order = np.argsort(ids)
    centroids = None if seen.centroids is None else seen.centroids[order]
    return replace(seen, ids=ids[order], corners=seen.corners[order], centroids=centroids)
