"""What is doubtful reaches a person and a program: text, error sentence, result.json."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path

from tests.cli.conftest import TILTED, Ran
from venus3d.engine.geometry.pose import Pose

Run = Callable[..., Ran]
Photographs = Callable[[str, Sequence[Pose]], Path]


def test_another_dictionary_and_swapped_sizes_are_the_errors_cause(
    run: Run, tilted_pictures: Path
) -> None:
    assert run("calibrate", tilted_pictures, "--board.dictionary", "DICT_4X4_50").sentence == (
        "The picture shows markers of DICT_5X5_1000 (27 different ones), not of DICT_4X4_50; "
        "start with --board.dictionary DICT_5X5_1000."
    )
    swapped = ("--board.columns", 6, "--board.rows", 9)
    assert run("calibrate", tilted_pictures, *swapped).sentence == (
        "The markers lie as on a board of 9 columns, not as on the board of 6 columns and 9 rows "
        "asked for: the two are swapped; start with --board.columns 9 --board.rows 6."
    )


def test_weak_views_are_told_in_words_and_in_the_result(
    run: Run, photographs: Photographs, tmp_path: Path
) -> None:
    """The same six places, hardly tilted: cause and cure in the text, the kinds in both JSONs."""
    flat = [Pose.from_vector([0.25 * a, 0.25 * b, c, *t]) for a, b, c, *t in TILTED]
    ran = run("calibrate", photographs("flat", flat), "--output", tmp_path, "--json")
    assert ran.code == 0, ran.err
    written = json.loads((tmp_path / "result.json").read_text())
    assert written["diagnoses"] == ran.json["diagnoses"]
    first = written["diagnoses"][0]
    assert first["kind"] == "parallel-views" and first["views"] == []
    lines = ran.out.splitlines()
    index = lines.index(f"Diagnosis: {first['cause']}")
    assert lines[index + 1].strip() == f"Cure: {first['cure']}"
    assert any(first["cause"].removesuffix(".") in said for said in written["warnings"])


def test_good_views_have_no_diagnosis(run: Run, tilted_pictures: Path) -> None:
    ran = run("calibrate", tilted_pictures, "--json")
    kinds = {diagnosis["kind"] for diagnosis in ran.json["diagnoses"]}
    assert not kinds & {"parallel-views", "weak-focal-length", "outlying-view", "correlated"}


def test_guidance_that_never_sees_the_board_says_which_it_saw(
    run: Run, tilted_pictures: Path
) -> None:
    """Also in a recording too short for the look that a running session takes now and then."""
    swapped = ("--board.columns", 6, "--board.rows", 9)
    sentence = run("guide", tilted_pictures, "--headless", *swapped).sentence
    assert sentence.endswith("two are swapped; start with --board.columns 9 --board.rows 6.")
