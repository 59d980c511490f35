"""Lens models: how a lens maps directions to normalised image coordinates."""

from __future__ import annotations

from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.lenses.brown import BROWN3, BROWN4, BROWN5, PINHOLE, Brown
from venus3d.engine.geometry.lenses.fisheye import EQUIDISTANT, FISHEYE, Fisheye
from venus3d.engine.geometry.lenses.lens_model import LensModel
from venus3d.engine.geometry.lenses.rational import RATIONAL, RATIONAL_THIN_PRISM, Rational

LENSES: dict[str, LensModel] = {
    lens.name: lens
    for lens in (
        PINHOLE,
        BROWN3,
        BROWN4,
        BROWN5,
        RATIONAL,
        RATIONAL_THIN_PRISM,
        EQUIDISTANT,
        FISHEYE,
    )
}
"""By name, those of one family from few coefficients to many."""

AUTO = "auto"
"""Instead of a lens model's name: it is found out."""

__all__ = [
    "AUTO",
    "BROWN3",
    "BROWN4",
    "BROWN5",
    "EQUIDISTANT",
    "FISHEYE",
    "LENSES",
    "PINHOLE",
    "RATIONAL",
    "RATIONAL_THIN_PRISM",
    "Brown",
    "Fisheye",
    "LensModel",
    "Rational",
    "lens_called",
    "lens_chosen",
]


def lens_called(name: str) -> LensModel:
    """The lens model of this name. Raises `CalibrationError` if there is none."""
    if name not in LENSES:
        raise CalibrationError(f"There is no lens model {name!r}; use one of {', '.join(LENSES)}.")
    return LENSES[name]


def lens_chosen(name: str) -> LensModel | None:
    """The lens model of this name, None for "auto". Raises `CalibrationError` for neither."""
    if name != AUTO and name not in LENSES:
        named = ", ".join((AUTO, *LENSES))
        raise CalibrationError(f"There is no lens model {name!r}; use one of {named}.")
    return None if name == AUTO else LENSES[name]
