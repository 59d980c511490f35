"""Sources of frames: camera, stream, video, folder, simulation."""
