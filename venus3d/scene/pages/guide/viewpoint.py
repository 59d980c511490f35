"""Where each tab looks at the scene from: at camera, board and target, or at the strip of steps.

A tab's scene may be wide or narrow; what is to be seen must fit its width.
"""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

from venus3d.engine.geometry.pose import Pose
from venus3d.scene.render.shapes import LineShape, Shape
from venus3d.scene.render.strip import STRIP_CENTRE, bounds_of

_Point = tuple[float, float, float]
_FOV_RAD = float(np.radians(42.0))
# Where the person looks from: behind, above and to the side of the camera.
_LOOK_FROM, _LOOK_AT = (-0.60, -0.42, -0.33), (0.015, 0.04, 0.235)
_NEAR_TARGET = 0.45
"""Up to this distance of the target, metres, the scene is seen from `_LOOK_FROM`."""
_ROOMY_ASPECT = 0.9
"""Width over height of a scene in which everything fits from there."""
_PHONE_ASPECT = 0.55
"""A scene as narrow as this is a phone's, whose panels cover all but the upper part."""
_OTHER_SHAPE = 0.15
"""A change of the aspect by more than this share turns the tab anew."""
_PHONE_RAISED = 0.6
"""What is looked at stands so high above the middle there, in halves of the height."""


class TabCamera:
    """The browsers' cameras of one server."""

    def __init__(self, server: viser.ViserServer) -> None:
        """Everybody looks at the whole scene."""
        self._server = server
        camera = server.initial_camera
        camera.fov, camera.near, camera.far = _FOV_RAD, 0.01, 50.0
        self._from: NDArray[np.float64] = np.array(_LOOK_FROM)
        self._at: NDArray[np.float64] = np.array(_LOOK_AT)
        self._fill = _ROOMY_ASPECT
        self.look(_LOOK_FROM, _LOOK_AT)
        server.on_client_connect(self._follow)

    def follow(self, shapes: tuple[Shape, ...], target: int, before: object) -> object:
        """Turn the tabs' cameras once when the strip comes, is another one, or goes, or when the
        target, whose number that is, is far away.

        Gives back what is looked at now: the `before` of the next call.
        """
        strip = [shape for shape in shapes if shape.name.startswith("/strip/")]
        goals = [s.pose for s in shapes if isinstance(s, LineShape) and s.name == "/target/board"]
        back = steps_back(goals[0].distance_to(Pose.identity()) if goals else 0.0)
        # Another pose of the same number is another strip.
        now = (True, target, goals[0].vector().tobytes()) if strip else (False, back)
        if now != before and strip:
            self.look_at_strip(bounds_of(strip))
        elif now != before:
            self.look_at_scene(back)
        return now

    def look_at_scene(self, back: float) -> None:
        """Every tab looks at camera, board and target, from `back` times as far away as usual."""
        self.look(back * np.array(_LOOK_FROM), back * np.array(_LOOK_AT))

    def look_at_strip(self, bounds: NDArray[np.float64]) -> None:
        """Every tab looks from behind the camera at a strip with these bounds, (2, 3), metres."""
        x, y, z = STRIP_CENTRE
        width = 1.1 * float(bounds[1, 0] - bounds[0, 0])
        # What stands in front of the steps' common depth (where the board comes from) looks larger
        # and needs room as well.
        distance = 0.5 * width / np.tan(_FOV_RAD / 2) + max(0.0, z - float(bounds[0, 2]))
        self.look((x, y - 0.25 * distance, z - distance), (x, y, z), fill=1.0)

    def look(
        self,
        position: NDArray[np.float64] | _Point,
        look_at: NDArray[np.float64] | _Point,
        *,
        fill: float = _ROOMY_ASPECT,
    ) -> None:
        """Every tab looks from here to there; those whose scene is narrower than `fill` (width over
        height) from as much farther away."""
        self._from, self._at, self._fill = np.asarray(position), np.asarray(look_at), fill
        initial = self._server.initial_camera
        initial.position, initial.look_at = position, look_at
        for client in self._server.get_clients().values():
            self._turn(client)

    def _follow(self, client: viser.ClientHandle) -> None:
        # A page that is laid out otherwise, or a window of another size, needs another distance.
        turned_at = 0.0

        def fit() -> None:
            nonlocal turned_at
            aspect = _aspect(client)
            if abs(aspect - turned_at) > _OTHER_SHAPE * aspect:
                turned_at = aspect
                self._turn(client)

        fit()
        client.camera.on_update(lambda _: fit())

    def _turn(self, client: viser.ClientHandle) -> None:
        camera, aspect = client.camera, _aspect(client)
        offset = max(1.0, self._fill / aspect) * (self._from - self._at)
        low = np.zeros(3)
        if aspect < _PHONE_ASPECT < self._fill:
            low[1] = _PHONE_RAISED * np.tan(_FOV_RAD / 2) * float(np.linalg.norm(offset))
        with client.atomic():
            camera.position, camera.look_at = self._at + offset + low, self._at + low


def _aspect(client: viser.ClientHandle) -> float:
    """Width over height of this tab's scene."""
    return max(0.4, client.camera.image_width / max(client.camera.image_height, 1))


def steps_back(distance: float) -> float:
    """How much farther away to look from, 1 ... 2.5, so that a target `distance` metres away from
    the camera is seen; in halves, so that the view a person has turned to is mostly kept."""
    return float(min(2.5, max(1.0, np.ceil(2 * distance / _NEAR_TARGET) / 2)))
