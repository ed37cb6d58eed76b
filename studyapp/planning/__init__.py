"""What a study needs before it begins: sample size, power, and what a pilot tells of them."""
