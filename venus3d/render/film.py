"""Pictures as an MP4 film. PyAV's wheels include the encoder, which imageio would download."""

from __future__ import annotations

import io
from collections.abc import Iterable
from typing import Any

import av
import numpy as np

from venus3d.render.projections import Picture


def mp4(pictures: Iterable[Picture], fps: int) -> bytes:
    """H.264 in MP4, for every browser and projector. Raises `ValueError` without frames."""
    buffer = io.BytesIO()
    stream: Any = None
    with av.open(buffer, "w", format="mp4") as container:
        for picture in pictures:
            if stream is None:
                stream = container.add_stream("libx264", rate=fps, options={"crf": "20"})
                stream.height, stream.width = picture.shape[:2]
                stream.pix_fmt = "yuv420p"
            frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="rgb24")
            container.mux(stream.encode(frame))
        if stream is None:
            raise ValueError("a film needs a picture")
        container.mux(stream.encode())
    return buffer.getvalue()
