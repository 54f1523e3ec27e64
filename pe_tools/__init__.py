"""What stands round the engine and needs no Blender: files, exchange, pictures, pages, commands."""
