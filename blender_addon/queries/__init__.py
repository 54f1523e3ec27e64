"""What is asked of a scene: warnings, a location, a test body, places of a sensor."""
