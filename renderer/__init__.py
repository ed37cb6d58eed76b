"""Motion and speech to video: body, scene, offscreen frames, encoder, side-by-side pairs."""
