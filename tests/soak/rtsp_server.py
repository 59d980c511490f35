"""An RTSP server for `live_sources.py`, by GStreamer; run by the system's Python, which has `gi`.

/usr/bin/python3 rtsp_server.py PORT VIDEO.mp4      an H.264 video, as it is
"""

import sys

import gi  # type: ignore[import-not-found]

gi.require_version("Gst", "1.0")
gi.require_version("GstRtspServer", "1.0")
from gi.repository import GLib, Gst, GstRtspServer  # type: ignore[import-not-found]  # noqa: E402

Gst.init(None)
server = GstRtspServer.RTSPServer(service=sys.argv[1])
factory = GstRtspServer.RTSPMediaFactory()
factory.set_launch(
    f"( filesrc location={sys.argv[2]} ! qtdemux ! h264parse ! rtph264pay name=pay0 pt=96 )"
)
server.get_mount_points().add_factory("/video", factory)
server.attach(None)
GLib.MainLoop().run()
