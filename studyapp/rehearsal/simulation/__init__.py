"""What simulated participants are like: whom they are drawn from, and what they answer."""
