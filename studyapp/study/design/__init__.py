"""Which trials a participant gets, in which order and with which sides: pure rules."""
