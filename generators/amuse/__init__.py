"""AMUSE: speech disentangled into content, emotion and style, and motion by latent diffusion.

Chhatre et al., CVPR 2024.
"""
