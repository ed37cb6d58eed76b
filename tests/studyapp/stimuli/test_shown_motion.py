from motion.segment import Segment
from studyapp.stimuli.shown_motion import segment_scene
from studyapp.study.folder import StudyFolder
from tests.support.studies.takes import write_motion, write_speech


def test_other_speech_is_cut_to_the_motions_length(folder: StudyFolder) -> None:
    folder.speech.mkdir()
    write_speech(folder.speech / "take.wav", 5.0)
    short, long, gone = (
        Segment(name=name, wav=wav, start=start, end=end, speaker="robin", emotion="neutral")
        for name, wav, start, end in (
            ("short", "take.wav", 0.0, 2.0),
            ("long", "take.wav", 2.0, 5.0),
            ("gone", "gone.wav", 0.0, 2.0),
        )
    )
    write_motion(folder.clip("ours", "short"), 2.0)

    def speech_seconds(speech: Segment | None) -> float | None:
        scene, missing = segment_scene(folder, folder.study(), short, ["ours"], speech=speech)
        assert (list(scene.clips), missing) == (["ours"], {})
        return None if scene.speech is None else round(scene.speech.duration, 3)

    assert [speech_seconds(speech) for speech in (short, long, gone, None)] == [2, 2, None, None]
