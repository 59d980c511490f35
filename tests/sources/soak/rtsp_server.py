"""An RTSP server for `rtsp_camera.py`, by GStreamer; run by the system's Python, which has `gi`.

/usr/bin/python3 rtsp_server.py PORT WIDTH HEIGHT RATE      sends as H.264 the pictures (BGR bytes)
                                                            that come on stdin; ends with them
SIGUSR1 begins and ends to lose one packet in twelve, and with it a slice of a picture.
"""

import random
import signal
import sys
import threading

import gi  # type: ignore[import-not-found]

gi.require_version("Gst", "1.0")
gi.require_version("GstRtspServer", "1.0")
from gi.repository import GLib, Gst, GstRtspServer  # type: ignore[import-not-found]  # noqa: E402

port, (width, height, rate) = sys.argv[1], map(int, sys.argv[2:])
sources = []
loses = False


def feed() -> None:
    """Hand each picture to the media that there is now."""
    while len(picture := sys.stdin.buffer.read(3 * width * height)) == 3 * width * height:
        for source in sources[-1:]:
            source.emit("push-buffer", Gst.Buffer.new_wrapped(picture))
    loop.quit()


def configure(_, media) -> None:
    """Feed new media, and lose what it sends if that is asked for."""
    element = media.get_element()
    payloader = element.get_by_name("pay0").get_static_pad("src")
    kinds = Gst.PadProbeType.BUFFER | Gst.PadProbeType.BUFFER_LIST
    payloader.add_probe(kinds, lose)
    sources.append(element.get_by_name("pictures"))


def lose(*_):
    lost = loses and random.random() < 1 / 12
    return Gst.PadProbeReturn.DROP if lost else Gst.PadProbeReturn.OK


def switch() -> bool:
    global loses
    loses = not loses
    return True


Gst.init(None)
server = GstRtspServer.RTSPServer(service=port)
factory = GstRtspServer.RTSPMediaFactory()
factory.set_launch(
    "( appsrc name=pictures is-live=true do-timestamp=true format=time max-buffers=2 max-bytes=0 "
    f"leaky-type=downstream caps=video/x-raw,format=BGR,width={width},height={height},"
    f"framerate={rate}/1 ! videoconvert ! video/x-raw,format=I420 "
    f"! x264enc tune=zerolatency sliced-threads=true threads=4 "
    f"speed-preset=ultrafast pass=quant quantizer=14 key-int-max={rate} "
    "! rtph264pay name=pay0 pt=96 config-interval=1 )"
)
factory.set_shared(True)
factory.connect("media-configure", configure)
server.get_mount_points().add_factory("/video", factory)
server.attach(None)
loop = GLib.MainLoop()
GLib.unix_signal_add(GLib.PRIORITY_DEFAULT, signal.SIGUSR1, switch)
threading.Thread(target=feed, daemon=True).start()
loop.run()
