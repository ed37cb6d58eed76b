"""DiffSHEG: speech to face and body together, by diffusion (Chen et al., CVPR 2024)."""
