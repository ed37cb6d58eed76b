"""Pictures and videos that a paper shows: they name the conditions, so participants never see them.

One kind of figure a module; all draw through `renderer.clip_video.Stage`, with the study's camera.
"""
