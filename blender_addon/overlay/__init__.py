"""What the 3D view shows of the sensors: beams, and where the vehicle stops them; frustums."""
