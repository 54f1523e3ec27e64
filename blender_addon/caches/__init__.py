"""What is read from a scene once a change, and who hears of the change."""
