"""`venus3d import`: another program's camera file as a camera.yaml."""

from __future__ import annotations

from venus3d.cli.export import export_command
from venus3d.cli.options import ExportOptions, ImportOptions
from venus3d.storage.formats import import_camera


def import_command(options: ImportOptions) -> None:
    """Read, write, and print the camera. Raises `VenusError` for a user's mistake."""
    camera = import_camera(options.file, options.format, name=options.name).camera
    export_command(
        ExportOptions(
            options.file,
            to="opencv-yaml",
            output=options.output,
            format=options.format,
            name=options.name,
        )
    )
    print(f"  {camera.width} x {camera.height} px")
    for name, value in camera.named.items():
        print(f"  {name} {value:12.6g}")
