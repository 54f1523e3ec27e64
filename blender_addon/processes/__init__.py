"""The engine's process: requests, what it runs without Blender, and the jobs of a scene."""
