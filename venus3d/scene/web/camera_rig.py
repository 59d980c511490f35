"""The scene cameras of a page's tabs, or of one tab, and their flights between views.

    rig = CameraRig(server, wake=page.wake)                 # or CameraRig(client), for one tab
    rig.go(lambda aspect: view_from("outside", camera, points, aspect))
    ... in the drawing loop: if rig.is_due: rig.advance()

A flight begins with `go`: from then on until the browser has confirmed its end, the rig has not
`arrived`, and what is drawn for one eye only (`SceneView`) has to wait.

A view is a function of the window's aspect (width over height), so that it fits every tab. A new
tab, or one whose aspect changes, jumps to the view at once. A browser that is still setting up its
scene may drop or change a view; each is sent again until the browser confirms it.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import viser

from venus3d.engine.geometry.pose import Array
from venus3d.render.viewpoints import FLIGHT_SECONDS, SceneCamera, between
from venus3d.scene.web import texts
from venus3d.scene.web.help import Command
from venus3d.scene.web.keys import KEYS
from venus3d.scene.web.scene_view import Host
from venus3d.scene.web.window import wants_less_motion

Framing = Callable[[float], SceneCamera]
"""How a scene is framed: the view for a window of this width over height."""
NEAR, FAR = 0.01, 50.0
"""Clipping planes, metres."""
_USUAL_ASPECT = 1.0
_RESENT, _FIRST_RESENT_S = 5, 0.25
"""How often an unconfirmed view is sent again, and after how long at first: twice as long
each time."""
_A_TURN = 0.5
"""Two reports nearer than this, relative to the distance looked at, are a person's movement; what a
browser does while it starts are jumps."""
_RESHAPED = 0.01
"""Relative change of a window's aspect beyond which its view is set again."""
_SAME = 0.01
"""Two views that differ by less than this, relative to the distance looked at, are the same."""
_ECHO_S = 3.0
"""How late a browser may report a view that it was sent."""
_KEPT = 60
"""Number of the newest views that it may report at any time: the last flight's, on a machine that
takes longer."""
_TOLD_AFTER_S, _TOLD_S = 0.8, 6.0
"""How long after its beginning a person is told what a movement means, and for how long."""
_EDGE = 0.97
"""Share of the window's half width and height beyond which something leaves the frame."""


class CameraRig:
    """The cameras of all tabs of a server, or of one tab. One thread calls `go`, `refit` and
    `advance`.

    A tab whose camera a person moves is left alone until `fit` or `go`, or until the person chooses
    viser's "Reset View".
    """

    def __init__(self, host: Host, *, wake: Callable[[], None] = lambda: None) -> None:
        """Nothing moves until `go`. `wake` is called on viser's threads when `advance` is due
        without a flight."""
        self.host, self._wake = host, wake
        self._tabs: dict[int, _Tab] = {}
        self._framing: Framing | None = None
        self._usual: SceneCamera | None = None
        self._lock = threading.Lock()
        if isinstance(host, viser.ClientHandle):
            self._come(host)
        else:
            host.initial_camera.near, host.initial_camera.far = NEAR, FAR
            host.on_client_connect(self._come)
            host.on_client_disconnect(self._leave)

    def go(self, framing: Framing, *, at_once: bool = False) -> None:
        """Fly to this view, or jump there, in every tab; where less motion is asked for, jump."""
        for tab in self._all:
            tab.turned_at = None
        self.refit(framing, at_once=at_once)

    def refit(self, framing: Framing, *, at_once: bool = False) -> None:
        """The same, but only in tabs whose camera nobody has moved."""
        self._framing = framing
        if not isinstance(self.host, viser.ClientHandle):
            # The goal of "Reset View", and what a new tab shows before its own view comes.
            first, usual = self.host.initial_camera, framing(_USUAL_ASPECT)
            self._usual = usual
            first.position, first.look_at, first.fov = usual.position, usual.look_at, usual.fov_rad
        for tab in self._all:
            tab.leave(at_once=at_once)

    def fit(self, client: viser.ClientHandle) -> None:
        """Fly one tab back to the view that the page gives it."""
        with self._lock:
            tab = self._tabs.get(client.client_id)
        if tab is not None:
            tab.turned_at = None
            tab.leave()
            self._wake()

    @property
    def command(self) -> Command:
        """Fits the tab in which it is asked for."""
        return Command(
            texts.FIT_COMMAND,
            KEYS["fit"],
            texts.FIT_COMMAND_HINT,
            lambda: None,
            do_in_tab=self.fit,
        )

    @property
    def aspect(self) -> float:
        """Width over height of a window that shows the page's view."""
        tabs = self._all
        return next((tab.window for tab in tabs if tab.turned_at is None), _USUAL_ASPECT)

    @property
    def arrived(self) -> bool:
        """Whether each tab shows the view that it was last asked for, or its person's own."""
        host = self.host
        clients = [host] if isinstance(host, viser.ClientHandle) else host.get_clients().values()
        with self._lock:
            tabs = [self._tabs.get(client.client_id) for client in clients]
        # viser lists a new tab a moment before it announces it.
        return all(tab is not None and tab.has_arrived for tab in tabs)

    @property
    def eyes(self) -> Array:
        """(T, 3) the eyes of the tabs that show the page's view, without those in flight."""
        goals = [tab.goal for tab in self._all if tab.is_at_goal]
        return np.array([goal.position for goal in goals if goal is not None]).reshape(-1, 3)

    def cuts_off(self, points: Array) -> bool:
        """Whether one of these points (N, 3) is outside a window that shows the page's view."""
        return any(tab.cuts_off(points) for tab in self._all)

    @property
    def is_due(self) -> bool:
        """Whether `advance` has something to do."""
        return self._framing is not None and any(tab.is_due for tab in self._all)

    def advance(self) -> None:
        """Advance the cameras."""
        if self._framing is None:
            return
        for tab in self._all:
            if tab.is_due:
                if tab.turned_at is None:
                    tab.advance(self._framing)
                else:
                    tab.tell()

    @property
    def _all(self) -> tuple[_Tab, ...]:
        with self._lock:
            return tuple(self._tabs.values())

    def _come(self, client: viser.ClientHandle) -> None:
        tab = _Tab(client, calm=wants_less_motion(client))
        tab.first = tab.reported = tab.seen
        with self._lock:
            self._tabs[client.client_id] = tab

        # Also when the window is resized. On the loop's thread: what is read there is what the
        # browser has just sent, and not what was set meanwhile.
        async def moved(_: object) -> None:
            tab.report(self._usual)
            if self._framing is not None and tab.is_due:
                self._wake()

        client.camera.on_update(moved)
        self._wake()

    def _leave(self, client: viser.ClientHandle) -> None:
        with self._lock:
            self._tabs.pop(client.client_id, None)


@dataclass(eq=False)
class _Tab:
    """One tab's camera."""

    client: viser.ClientHandle
    calm: bool = False
    """Whether its person wants no flights."""
    start: SceneCamera | None = None
    """Start of the flight; None without one."""
    begun: float = 0.0
    aspect: float = 0.0
    """The window's aspect when its view was last set."""
    goal: SceneCamera | None = None
    settled: bool = False
    """Whether the browser has shown the goal, or never will, or a person has moved the camera."""
    resent: int = 0
    left_alone: bool = False
    """Whether the view was sent often enough to a browser that did not confirm it."""
    sent_at: float = 0.0
    sent: tuple[tuple[float, SceneCamera], ...] = ()
    """The newest views, and when they were sent: what the browser reports back. Replaced as a
    whole, since two threads use it."""
    first: SceneCamera | None = None
    """What the browser showed when it came; "Reset View" may lead back there."""
    reported: SceneCamera | None = None
    strange: bool = False
    """Whether the browser has last reported a view on the way that it was not sent."""
    turned_at: float | None = None
    """When a person began to move the camera away from the page's view; None while it shows it."""
    told: bool = False

    @property
    def seen(self) -> SceneCamera:
        camera = self.client.camera
        return SceneCamera(camera.position.copy(), camera.look_at.copy(), camera.fov)

    @property
    def window(self) -> float:
        camera = self.client.camera
        return camera.image_width / max(camera.image_height, 1)

    @property
    def is_due(self) -> bool:
        turned_at = self.turned_at
        if turned_at is not None:
            return not self.told and time.monotonic() - turned_at > _TOLD_AFTER_S
        return self.start is not None or self._is_reshaped or self._unheard

    @property
    def _is_reshaped(self) -> bool:
        """Whether the window has another aspect than its view was made for."""
        return abs(self.window - self.aspect) > _RESHAPED * self.window

    @property
    def has_arrived(self) -> bool:
        if self.turned_at is not None:
            return True
        return self.is_at_goal and self.settled and not self._is_reshaped

    @property
    def _unheard(self) -> bool:
        """Whether the browser has had time enough to confirm its view, and has not."""
        if self.settled or self.goal is None:
            return False
        return time.monotonic() - self.sent_at > _FIRST_RESENT_S * 2**self.resent

    @property
    def is_at_goal(self) -> bool:
        return self.goal is not None and self.turned_at is None and self.start is None

    def cuts_off(self, points: Array) -> bool:
        if self.goal is None or not self.is_at_goal:
            return False
        places = np.abs(self.goal.in_window(points, self.aspect))
        return not bool((places < _EDGE).all())  # NaN behind the eye

    def leave(self, *, at_once: bool = False) -> None:
        """Begin to fly, or to jump, from where it is; not from a view that a person has chosen."""
        if self.turned_at is None:
            jumps = at_once or self.calm or self.goal is None
            self.start = None if jumps else self.seen
            self.begun = time.monotonic()
            self.aspect = 0.0 if jumps else self.aspect

    def report(self, reset_view: SceneCamera | None) -> None:
        """Note where the browser says that its camera is."""
        seen, before = self.seen, self.reported
        self.reported = seen
        if self.goal is None:
            return
        self.settled = self.settled or _is_same(seen, self.goal)
        resets = [view for view in (reset_view, self.first) if view is not None]
        if self.turned_at is not None:
            if any(_is_same(seen, view) for view in resets):  # "Reset View" has been chosen
                self.turned_at = None
                self.leave()
            return
        shown = (*(view for _, view in self.sent), *resets)
        known = (*shown, *map(_before_up, shown))
        turned = not _is_mixed(seen, known) and before is not None and _is_turned(before, seen)
        # A busy browser was once late in the middle of a flight with a view of its own making; a
        # person's movement goes on.
        sure, self.strange = self.settled or self.strange, turned
        if turned and sure:
            self.settled, self.start = True, None
            self.turned_at = time.monotonic()
        elif self.left_alone and not turned and not _is_same(seen, self.goal):
            # It was only slow, and stands where nobody wants it: once more.
            self.settled, self.left_alone, self.resent = False, False, _RESENT - 1

    def tell(self) -> None:
        """Tell the person, once, that the camera is theirs now, and how to give it back."""
        self.told = True
        self.client.add_notification(
            texts.VIEW_TURNED, texts.VIEW_TURNED_HOW, auto_close_seconds=_TOLD_S
        )

    def advance(self, framing: Framing) -> None:
        again = self._unheard
        self.aspect, self.sent_at = self.window, time.monotonic()
        goal = framing(self.aspect)
        if self.goal is None or _difference(goal, self.goal) > 1e-6:
            self.settled, self.left_alone, self.resent = False, False, 0
        elif again:
            self.resent += 1
            self.settled = self.left_alone = self.resent >= _RESENT
        self.goal = goal
        shown, done, start = self.goal, (self.sent_at - self.begun) / FLIGHT_SECONDS, self.start
        if start is not None and done < 1:
            shown = between(start, self.goal, max(0.0, done))
        else:
            self.start = None
        old, last = self.sent[:-_KEPT], self.sent[-_KEPT:]
        recent = (pair for pair in old if self.sent_at - pair[0] < _ECHO_S)
        self.sent = (*recent, *last, (self.sent_at, shown))
        with self.client.atomic():
            if again:
                # viser sends nothing that it thinks is there already.
                self._set(SceneCamera(shown.position + 1.0, shown.look_at, 0.9 * shown.fov_rad))
            self._set(shown)

    def _set(self, view: SceneCamera) -> None:
        camera = self.client.camera
        camera.position, camera.look_at = view.position, view.look_at
        camera.fov = view.fov_rad  # the browser answers this with its camera


def _is_turned(before: SceneCamera, after: SceneCamera) -> bool:
    """Whether a person turned or moved the camera a little between two reports."""
    return 1e-4 < _difference(before, after) < _A_TURN


def _is_same(one: SceneCamera, other: SceneCamera) -> bool:
    return _difference(one, other) < _SAME


def _before_up(view: SceneCamera) -> SceneCamera:
    """What a browser reports of a view while it does not know yet that our up is -y."""
    (x, y, z), (at_x, at_y, at_z) = view.position, view.look_at
    return SceneCamera(np.array([x, -z, y]), np.array([at_x, -at_z, at_y]), view.fov_rad)


def _is_mixed(seen: SceneCamera, known: Sequence[SceneCamera]) -> bool:
    """Whether eye and target point are each those of a known view: a browser may apply one before
    the other."""
    near = _SAME * float(np.linalg.norm(seen.position - seen.look_at))
    eyes = (float(np.linalg.norm(seen.position - view.position)) for view in known)
    targets = (float(np.linalg.norm(seen.look_at - view.look_at)) for view in known)
    return min(eyes, default=np.inf) < near and min(targets, default=np.inf) < near


def _difference(one: SceneCamera, other: SceneCamera) -> float:
    """How far eye and target point are apart, relative to the distance looked at."""
    eyes = float(np.linalg.norm(other.position - one.position))
    targets = float(np.linalg.norm(other.look_at - one.look_at))
    return max(eyes, targets) / max(float(np.linalg.norm(one.position - one.look_at)), 1e-6)
