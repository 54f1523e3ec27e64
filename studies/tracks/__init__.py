"""When is an object noticed: first sight and confirmed tracks against those of real traffic."""
