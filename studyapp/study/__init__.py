"""What a study is: its file, its folder, its protocol, its trials and its stimuli."""
