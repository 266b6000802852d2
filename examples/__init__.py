"""What the block is good for: whole examples, each a folder to start from."""
