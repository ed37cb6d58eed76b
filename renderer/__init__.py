"""Motion and speech to video: body, scene, frames, encoder, side-by-side pairs."""
