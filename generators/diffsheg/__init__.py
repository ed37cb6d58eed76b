"""DiffSHEG: speech to face and body together, by diffusion (Chen et al., CVPR 2024)."""

from generators.diffsheg.network_file import load_released as load_released
