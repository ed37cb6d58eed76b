"""The motion of BEAT's takes, whose headers are not always true."""

from __future__ import annotations

from motion.audio import read_audio
from motion.errors import InputError
from motion.formats.bvh import BvhFrameCountError, BvhMotion, read_bvh
from motion.formats.first_frame import settle_first_frame
from training.data.take import LONGEST_DIFFERENCE, Take


def read_beat_bvh(take: Take) -> BvhMotion:
    """Return the motion of a take without what was left over in its first row.

    Where the header promises another number of frames than there are, as in files that were
    thinned out, the frame rate is the header's, or that at which the frames last as long as the
    header says, whichever makes them as long as the sound.

    Raises
    ------
    InputError
        If the file is not a BVH or is damaged, or neither frame rate fits the sound.
    """
    try:
        motion = read_bvh(take.motion)
    except BvhFrameCountError as error:
        seconds = read_audio(take.speech).duration
        fitting = [
            rate
            for rate in error.frame_rates
            if abs(error.rows / rate - seconds) <= LONGEST_DIFFERENCE
        ]
        if not fitting:
            raise InputError(
                f"{error.what}, while the sound lasts {seconds:.2f} s",
                where=take.motion,
                remedy="Copy the motion again, or correct its header",
            ) from error
        motion = read_bvh(take.motion, frame_rate=fitting[0])
    return settle_first_frame(motion)
