"""AMUSE: speech taken apart into content, emotion and style, and motion by latent diffusion.

Chhatre et al., CVPR 2024.
"""

from generators.amuse.network_file import load_released as load_released
