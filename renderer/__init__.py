"""Rendering motion and speech as video: body, scene, frames, encoder, side-by-side pairs."""
