"""What the pairwise answers say: counts, win shares with intervals, side bias, emotions.

Every estimate treats participants and segments as samples: answers of one participant, and
answers about one segment, are not independent of each other.
"""
