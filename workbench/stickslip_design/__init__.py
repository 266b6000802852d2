"""Design studies of axes that stick and slip."""
