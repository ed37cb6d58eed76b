"""Pictures and videos for papers; they name the conditions, so participants never see them.

Each module has one kind of figure; all draw with `renderer.clip_video.Stage` and the study's
camera.
"""
