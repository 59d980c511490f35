"""Sobol's sequence: points spread evenly over the unit cube.

As `scipy.stats.qmc.Sobol(6, scramble=False)` gives them; importing that takes half a second, which
every program with a search would pay.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.pose import Array

_BITS = 30
# S. Joe and F. Y. Kuo 2008, new-joe-kuo-6.21201: for each dimension but the first the polynomial's
# coefficients and the first direction numbers.
_JOE_KUO = ((0, (1,)), (1, (1, 3)), (1, (1, 3, 1)), (2, (1, 1, 1)), (1, (1, 1, 3, 3)))


def _directions() -> NDArray[np.int64]:
    """(30, 6) what each bit of a point's number changes, in units of 2^-30."""
    columns = [[1] * _BITS]
    for coefficients, first in _JOE_KUO:
        m, s = list(first), len(first)
        for k in range(s, _BITS):
            new = m[k - s] ^ (m[k - s] << s)
            for i in range(1, s):
                new ^= ((coefficients >> (s - 1 - i)) & 1) * (m[k - i] << i)
            m.append(new)
        columns.append(m)
    shifts = np.arange(_BITS - 1, -1, -1)[:, None]
    return np.array(columns, dtype=np.int64).T << shifts


_DIRECTIONS = _directions()


def sobol(first: int, count: int) -> Array:
    """(count, 6) points number `first` and after, in [0, 1); the first of all is the origin."""
    numbers = np.arange(first, first + count)
    gray = numbers ^ (numbers >> 1)
    points = np.zeros((count, _DIRECTIONS.shape[1]), dtype=np.int64)
    for bit in range((first + count).bit_length()):
        points ^= ((gray >> bit) & 1)[:, None] * _DIRECTIONS[bit]
    return points / 2.0**_BITS
