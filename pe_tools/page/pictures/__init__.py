"""Pictures of a rig, made with the engine's own rays: the same bytes wherever it runs."""
