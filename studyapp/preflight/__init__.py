"""The checks of `motionjury check` before a study is launched."""
