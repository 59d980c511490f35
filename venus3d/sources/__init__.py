"""Where frames come from: camera, stream, video, folder, simulation."""
