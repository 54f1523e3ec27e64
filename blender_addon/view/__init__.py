"""What all drawing shares, and what is drawn as objects and pictures."""
