"""`venus3d teach`: serve the lessons, or write one to a file."""

from __future__ import annotations

from pathlib import Path

from venus3d.cli.report import print_note
from venus3d.scene.pages.teach.export.files import kind_of
from venus3d.scene.pages.teach.options import TeachOptions
from venus3d.scene.pages.teach.run import export_lesson, run_teach
from venus3d.storage.folder import prepare
from venus3d.storage.products import product_place, write_product

_MADE = "a lesson"


def teach(options: TeachOptions) -> None:
    """Serve the page until Ctrl-C, or export. Raises `VenusError` for a user's mistake."""
    options.check()
    if options.export is None:
        run_teach(options)
        return
    kind = kind_of(options.export)
    if kind != "png":  # how many there are of these is not known yet
        product_place(options.export, _MADE, option="--export")
    prepare(options.export.parent, "--export")
    files, notes = export_lesson(options, kind)
    for note in notes:
        print_note(note)
    names = [
        product_place(path, _MADE, option="--export") for path in _names(options.export, len(files))
    ]
    for path, content in zip(names, files, strict=True):
        print(f"Written: {write_product(path, content, _MADE, '--export')}")


def _names(path: Path, count: int) -> list[Path]:
    """A single name is kept; several are numbered."""
    if count == 1:
        return [path]
    return [path.with_name(f"{path.stem}-{n}{path.suffix}") for n in range(1, count + 1)]
