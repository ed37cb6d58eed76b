"""Feature networks: their input, training and scores. torch is loaded only with a network."""
