"""Windows that cover a motion, and go over into each other."""

from __future__ import annotations

import torch
from hypothesis import given
from hypothesis import strategies as st

from training.hearing.speech_windows import plan_windows


@given(total=st.integers(1, 5000), frames=st.integers(40, 300), fade=st.integers(1, 30))
def test_windows_cover_the_speech_and_share_at_least_the_fade(
    total: int, frames: int, fade: int
) -> None:
    plan = plan_windows(total, frames, fade)
    assert plan.starts[-1] + frames >= total
    if plan.count > 1:
        assert frames - plan.stride >= fade
        assert plan.starts[-1] < total
        assert plan.starts[-1] + frames - total < plan.count - 1


def test_one_motion_cut_into_windows_comes_back_whole() -> None:
    plan = plan_windows(95, 40, 6)
    motion = torch.randn(plan.starts[-1] + 40, 3)
    windows = torch.stack([motion[start : start + 40] for start in plan.starts])
    torch.testing.assert_close(plan.join(windows), motion)


def test_joined_windows_do_not_jerk_at_their_seams() -> None:
    plan = plan_windows(3000, 300, 30)
    random = torch.Generator().manual_seed(6)
    times = torch.arange(300) / 30
    phases, speeds = (torch.rand(plan.count, 1, 8, generator=random) for _ in range(2))
    waves = torch.sin(2 * torch.pi * ((0.5 + speeds) * times[:, None] + phases))
    windows = waves.mean(dim=-1, keepdim=True)
    joined = plan.join(windows)
    sizes = joined.diff(n=2, dim=0).abs()[:, 0]
    centres = torch.arange(len(sizes)) + 1
    at_seam = (centres >= plan.stride) & (centres % plan.stride < plan.fade)
    assert float(sizes[at_seam].mean() / sizes[~at_seam].mean()) < 1.2
