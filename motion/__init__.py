"""The shared words: motion clip, speech segment, skeleton, body layer, file formats, audio."""
