"""What is kept is kept for each language."""

from __future__ import annotations

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Pose
from venus3d.languages import PageLanguage, cached_by_language, current_language
from venus3d.render.board_mesh import held_board


def test_a_cache_does_not_give_one_language_s_text_to_another() -> None:
    """A board that an English page had drawn said LEFT on a German page."""
    made: list[str] = []

    @cached_by_language(maxsize=4)
    def greeting(name: str) -> str:
        made.append(current_language())
        return f"{current_language()} {name}"

    for _ in range(2):
        for code in ("en", "de"):
            with PageLanguage(code).spoken():
                assert greeting("Venus") == f"{code} Venus"
    assert made == ["en", "de"]


def test_the_board_s_back_speaks_the_page_s_language() -> None:
    backs: dict[str, bytes] = {}
    for code in ("en", "de"):
        with PageLanguage(code).spoken():
            _, back = held_board(Board(), Pose.from_vector([0, 0, 0, 0, 0, 0.5]))
            backs[code] = back.mesh.visual.material.baseColorTexture.tobytes()
    assert backs["en"] != backs["de"]
