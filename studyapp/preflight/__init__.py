"""What 'motionjury check' finds before a study is launched."""
