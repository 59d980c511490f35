"""What was captured stays: whatever ends the program, the files are whole and hold every view."""

from __future__ import annotations

import json
import random
import re
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import psutil
import pytest

from tests.cli.conftest import Ran
from tests.cli.programs import PATIENCE_S, OnATerminal, Program, kept, wait_until_there
from tests.ports import free_port
from tests.scene.raw_client import RawClient
from tests.waiting import wait_until
from venus3d.storage.camera_yaml import read_camera_yaml

pytestmark = pytest.mark.slow

Run = Callable[..., Ran]
Start = Callable[..., Program]
# Faster, and the hand mends by what it saw too long ago where a busy machine shows little.
LIVE = ("guide", "sim", "--autopilot", "--speed", "3", "--no-tour", "--camera-size", "640x360")
LIVE += ("--method", "pose-selection")  # what is kept does not depend on how a target is found
HEADLESS = ("guide", "sim", "--headless", "--max-views", "12", "--camera-size", "640x360")
HEADLESS += ("--method", "pose-selection")


@pytest.fixture
def start(tmp_path: Path, two_views: Path) -> Iterator[Start]:
    """Starts guided calibrations that write to `tmp_path / "out"`; none outlives the test. Unless
    `fresh`, they go on from two views."""
    started: list[Program] = []

    def start_one(
        *arguments: str, prefix: tuple[str, ...] = (), fresh: bool = False, **more: str
    ) -> Program:
        port = () if "--headless" in arguments else ("--port", str(free_port()))
        known = () if fresh else ("--from", str(two_views))
        output = ("--output", str(tmp_path / "out"))
        started.append(Program(*arguments, *port, *known, *output, prefix=prefix, **more))
        return started[-1]

    yield start_one
    for program in started:
        program.kill()


@pytest.mark.parametrize("mode", [LIVE, HEADLESS], ids=["live", "headless"])
def test_a_kill_at_any_moment_leaves_every_view_but_the_last(
    start: Start, tmp_path: Path, mode: tuple[str, ...]
) -> None:
    """Without any warning, at four moments: right after a view, and while the next is on its way.
    While a program stands still its folder is what a kill would leave, so one program has several
    such moments before it is killed; another one then goes on beside what that left.

    The view that was worked out a few milliseconds before the blow may still be in memory.
    """
    chance = random.Random(7)
    folder = tmp_path / "out"
    for run, moments in enumerate(((0.0, 0.002, 0.02), (1.0,))):
        program, views = start(*mode, "--no-record"), 2  # a recorded session is not begun twice
        for moment in moments:
            views = program.wait_for_views(views + 1)
            delay = moment * chance.random()
            if run == 0:
                wait_until_there(folder / "result.json")
            time.sleep(delay)
            with program.standing_still():
                newest = json.loads((folder / "result.json").read_text())
                read_camera_yaml(folder / "camera.yaml")
                assert views - 1 <= newest["views"] <= views + 1, (run, delay)
                assert newest["history"][-1]["views"] == newest["views"]
                # The runs before are there as well.
                for files in ("result*.json", "camera*.yaml"):
                    assert len(list(folder.glob(files))) == run + 1
        program.kill()


def test_files_are_whole_whenever_somebody_looks(start: Start, tmp_path: Path) -> None:
    """From the first view on, at any moment of a live calibration and of its end."""
    program = start(*LIVE, fresh=True)
    folder, seen = tmp_path / "out", [0]
    program.wait_for_views(1)
    wait_until_there(folder / "result.json")
    end = time.monotonic() + PATIENCE_S
    while program.process.poll() is None:
        assert time.monotonic() < end
        views = json.loads((folder / "result.json").read_text())["views"]
        read_camera_yaml(folder / "camera.yaml")
        if views != seen[-1]:
            seen.append(views)
        if views >= 3:
            program.send(signal.SIGTERM)
        time.sleep(0.001)  # and leave it a core
    assert seen == sorted(seen) and seen[1] <= 2 and seen[-1] >= 3, (
        "views were written as they came"
    )


@pytest.mark.parametrize(
    "blows",
    [
        (signal.SIGINT,),
        (signal.SIGTERM,),
        (signal.SIGHUP,),
        # The kernel and the shell both tell of a terminal that was closed.
        (signal.SIGHUP, signal.SIGHUP),
    ],
    ids=["ctrl-c", "kill", "hangup", "two-hangups"],
)
@pytest.mark.parametrize("mode", [LIVE, HEADLESS], ids=["live", "headless"])
def test_signals_that_ask_to_end_are_obeyed(
    start: Start, tmp_path: Path, mode: tuple[str, ...], blows: tuple[signal.Signals, ...]
) -> None:
    program = start(*mode)
    views = program.wait_for_views(3)
    program.send(*blows)
    code, out, err = program.ended()
    assert code == 0 and "Traceback" not in err, err
    result = kept(tmp_path / "out")
    assert result["views"] >= views and f" in {result['views']} views" in out
    assert out.count("Written: ") == 2


@pytest.mark.parametrize("mode", [LIVE, HEADLESS], ids=["live", "headless"])
def test_a_closed_terminal_ends_it_well(
    tmp_path: Path, two_views: Path, mode: tuple[str, ...]
) -> None:
    """A window that is closed: nothing can be printed any more, and all is on the disk."""
    port = () if "--headless" in mode else ("--port", str(free_port()))
    log, folder = tmp_path / "log", tmp_path / "out"
    known = ("--from", str(two_views))
    program = OnATerminal(*mode, *port, *known, "--output", str(folder), log=log)
    try:
        program.wait_for_views(3)
        program.close_terminal()
        assert program.process.wait(PATIENCE_S) == 0
    finally:
        program.kill()
    assert "Traceback" not in log.read_text() and "Exception" not in log.read_text()
    assert kept(folder)["views"] >= 3


@pytest.mark.parametrize("mode", [LIVE, HEADLESS], ids=["live", "headless"])
def test_nohup_is_heeded(start: Start, tmp_path: Path, mode: tuple[str, ...]) -> None:
    program = start(*mode, prefix=("nohup",))
    views = program.wait_for_views(1)
    program.send(signal.SIGHUP)
    assert program.wait_for_views(views + 1) > views, "it goes on"
    program.send(signal.SIGTERM)
    code, _, err = program.ended()
    assert code == 0 and "Traceback" not in err, err
    kept(tmp_path / "out")


def test_the_live_guide_searches_and_detects_in_processes_of_their_own(start: Start) -> None:
    """Nothing that draws shares the interpreter with them; one that dies costs no view."""
    program = start(*LIVE)
    views = program.wait_for_views(1)
    guide = psutil.Process(program.process.pid)
    own = [one for one in guide.children() if "spawn_main" in " ".join(one.cmdline())]
    assert len(own) == 2
    for one in own:
        one.kill()
    assert program.wait_for_views(views + 1) > views
    program.send(signal.SIGINT)
    code, _, err = program.ended()
    assert code == 0 and err.count("another one does its work") == 2, err


@pytest.mark.parametrize(
    ("mode", "where"),
    [
        (HEADLESS, "source"),
        (HEADLESS, "detector"),
        (LIVE, "source"),
        (LIVE, "detector"),
        (LIVE, "drawing"),
    ],
    ids=["headless-source", "headless-detector", "live-source", "live-detector", "live-drawing"],
)
def test_an_error_in_the_middle_leaves_the_result(
    start: Start, tmp_path: Path, mode: tuple[str, ...], where: str
) -> None:
    """A plain mistake in the program, after three views: told in full, for whoever mends it."""
    program = start(*mode, BREAK=f"{where}:3")
    code, _, err = program.ended()
    assert code == 2 and "RuntimeError: boom" in err, err
    assert kept(tmp_path / "out")["views"] == 3
    for name in ("camera.yaml", "result.json"):
        assert f"Written: {tmp_path / 'out' / name}" in err.splitlines()
    assert re.fullmatch(r"venus3d: The guidance broke off .*report .*\.", err.splitlines()[-1])


@pytest.mark.parametrize("mode", [LIVE, HEADLESS], ids=["live", "headless"])
def test_a_second_ctrl_c_during_the_last_calibration_leaves_the_views_before(
    start: Start, tmp_path: Path, mode: tuple[str, ...]
) -> None:
    program = start(*mode, BREAK="search:3")
    program.wait_for("searching")
    for _ in range(20):  # whoever is in a hurry; a busy program takes two presses for one
        time.sleep(0.3)
        program.send(signal.SIGINT)
        if program.process.poll() is not None:
            break
    code, _, err = program.ended()
    # The last press may come when Python already waits for the search that nobody ends.
    assert code in (130, -signal.SIGINT) and "Traceback" not in err, err
    assert kept(tmp_path / "out")["views"] == 3


def test_a_second_run_keeps_the_first_ones_result(run: Run, tmp_path: Path) -> None:
    arguments = [*HEADLESS, "--max-views", "2", "--output", tmp_path, "--no-record"]
    assert run(*arguments).code == 0
    first = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    ran = run(*arguments, "--seed", "1")
    said = re.search(r"^The earlier result in (.*) is kept as (\S+) and (\S+)\.$", ran.err, re.M)
    assert said is not None and said[1] == str(tmp_path), ran.err
    camera, result = said[2], said[3]
    assert (tmp_path / camera).read_bytes() == first["camera.yaml"]
    assert (tmp_path / result).read_bytes() == first["result.json"]
    assert camera.removesuffix(".yaml").removeprefix("camera") == result.removesuffix(
        ".json"
    ).removeprefix("result")
    assert (tmp_path / "result.json").read_bytes() != first["result.json"]
    assert len(list(tmp_path.iterdir())) == 4


def test_calibrate_keeps_the_earlier_result_too(
    run: Run, tmp_path: Path, tilted_pictures: Path
) -> None:
    (tmp_path / "camera.yaml").write_text("another program's")
    ran = run("calibrate", tilted_pictures, "--output", tmp_path)
    assert ran.code == 0, ran.err
    (aside,) = tmp_path.glob("camera-*.yaml")
    assert aside.read_text() == "another program's"
    assert f"The earlier result in {tmp_path} is kept as {aside.name}." in ran.err
    read_camera_yaml(tmp_path / "camera.yaml")


def test_a_session_without_a_view_leaves_the_earlier_result(start: Start, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / "camera.yaml").write_text("earlier")
    # Nobody moves the board, and nothing is captured by itself.
    program = start("guide", "sim", "--no-auto-capture", fresh=True)
    port = int(program.wait_for(r"http://\S+:(\d+)")[1])
    with RawClient(port) as tab:
        tab.look()
        while "/board/live" not in str(tab.window(timeout=60)):
            pass
    program.send(signal.SIGTERM)
    code, out, err = program.ended()
    assert code == 130 and "No view was captured" in out and "Traceback" not in err, err
    assert {path.name: path.read_text() for path in folder.iterdir()} == {"camera.yaml": "earlier"}


def test_a_folder_that_goes_in_the_middle_stops_nothing(start: Start, tmp_path: Path) -> None:
    """Removed, and then with a file in its place: that is told at each view; a folder that can be
    made anew is, and then holds all views."""
    program, folder = start(*LIVE, "--no-record"), tmp_path / "out"
    result = folder / "result.json"
    told = f"Not saved: camera.yaml and result.json cannot be written to {folder} (not a directory)"
    views = program.wait_for_views(3)
    wait_until_there(result)
    folder.rename(tmp_path / "gone")
    views = program.wait_for_views(views + 1)
    wait_until(
        lambda: result.exists() and json.loads(result.read_text())["views"] >= views,
        "all views are in a new folder",
        PATIENCE_S,
    )
    assert "Not saved" not in program.complaints()
    folder.rename(tmp_path / "gone as well")
    folder.write_text("in the way")
    views = program.wait_for_views(views + 1)
    wait_until(lambda: told in program.complaints(), "it is told", PATIENCE_S)
    folder.unlink()
    views = program.wait_for_views(views + 1)
    before = program.complaints()
    program.send(signal.SIGTERM)
    code, _, err = program.ended()
    assert code == 0 and "Traceback" not in before + err, before + err
    assert kept(folder)["views"] >= views


def test_a_folder_that_never_comes_back_is_told_after_the_numbers(
    start: Start, tmp_path: Path
) -> None:
    program, folder = start(*HEADLESS, "--no-record"), tmp_path / "out"
    program.wait_for_views(3)
    wait_until_there(folder / "result.json")
    folder.rename(tmp_path / "gone")
    folder.write_text("in the way")
    program.wait_for_views(4)
    program.send(signal.SIGTERM)
    code, out, err = program.ended()
    assert code == 2 and "Traceback" not in err, err
    assert "focal length, horizontal" in out and "Written" not in out
    assert err.splitlines()[-1].startswith("venus3d: camera.yaml and result.json cannot be written")
