"""Split a pose into four steps: from the upright board, and from where the board is held now."""

import venus3d


def main() -> None:
    camera = venus3d.Camera(1280, 720, 1068, 1073, 635, 355)
    board = venus3d.Board()
    # Turns about the camera's X, Y, Z axes in degrees, then the board's centre in metres.
    target = venus3d.Pose.from_vector([25, -30, 20, 0.04, -0.02, 0.52])

    print("From the upright, frontal board, as the camera's picture shows it:")
    for step in venus3d.decompose(target, camera, board):
        print(f"  {step.number}. {venus3d.step_prompt(step).camera}")

    now = venus3d.Pose.from_vector([20, -5, 15, 0.03, -0.02, 0.50])
    print("From where the board is now, in the words of the person who holds it:")
    for step in venus3d.decompose(target, camera, board, start=now):
        print(f"  {step.number}. {venus3d.step_prompt(step).holder}")

    # The turns are about the camera's axes; about the board's own axes it is another pose.
    other = venus3d.Pose.from_vector(target.vector(), axes="own")
    print(f"The same numbers about the board's own axes: {target.angle_to_deg(other):.1f}° away.")


if __name__ == "__main__":
    main()
