"""`motionjury init`: what a study is to be, in options or asked question by question."""
