"""Take a pose apart into four steps: from the start, and from where a board is held now."""

from __future__ import annotations

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import decompose
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.prompts import step_words


def main() -> None:
    camera = Camera(1280, 720, 1068, 1073, 635, 355)
    board = Board()
    target = Pose.from_vector([25, -30, 20, 0.04, -0.02, 0.52])  # degrees, metres

    print("From the upright, frontal board (eq. 15 of the paper):")
    for step in decompose(target, camera, board):
        print(f"  {step.number}. {step_words(step).camera}")

    # A board that is held somehow: what is left of each degree of freedom?
    now = Pose.from_vector([20, -5, 15, 0.03, -0.02, 0.50])
    print("From where the board is now, in the words of the person who holds it:")
    for step in decompose(target, camera, board, start=now):
        print(f"  {step.number}. {step_words(step).holder}")

    # The turns are about the camera's axes; about the board's own axes it is another pose.
    other = Pose.from_vector(target.vector(), axes="own")
    print(f"The same numbers about the board's own axes: {target.angle_to_deg(other):.1f}° away.")


if __name__ == "__main__":
    main()
