"""The page that a folder for another lab begins with."""

from __future__ import annotations

from studyapp.study.settings.study import Study


def read_me(study: Study, *, people: int, study_folder: str) -> str:
    """Return what the folder holds, and how its results are repeated."""
    return f"""\
# {" ".join(study.title.split())}

Answers of {people} participants of a {study.protocol} study, made with Motion Jury. The folder
follows BIDS for behavioural data; what BIDS has no place for is in `sourcedata`.

```
participants.tsv            who took part, and whom the analysis leaves out, by which rule
sub-*/beh/*_beh.tsv         one row for each answer, with sides, times and what was watched
phenotype/form.tsv          what participants said about themselves
sourcedata/study            the study: its file as it was, speech, motion, and the answers
sourcedata/stimuli.tsv      every video that was shown, with its SHA-256
sourcedata/watching.tsv     how each video was watched
sourcedata/versions         every version of the study file, and the digests of their designs
sourcedata/codebook.md      what columns and values mean, and the wording of the questions
sourcedata/environment.json the versions of all packages
SHA256SUMS                  of every file; `sha256sum --check SHA256SUMS` compares them
```

## Repeating the results

With the same version of Motion Jury and of the packages that `sourcedata/environment.json` lists,

    motionjury report {study_folder}

writes `{study_folder}/report/results.json` again, byte for byte. Where `sourcedata/results.json` is
there, it is the one of the lab that made this folder.

## Who is in it

Participants are named by pseudonyms. They are keyed hashes: without the key, which is not here,
they lead back to nobody. There are no dates but the days on which researchers looked at results
(`shared_answers/looks.csv`): times are seconds since a participant's consent. Of who withdrew, only
the number is here. `study_session` counts participants in the order in which they came; the report
names them by it.
"""
