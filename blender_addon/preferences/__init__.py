"""The extension's preferences: own sensors, verification, English names."""
