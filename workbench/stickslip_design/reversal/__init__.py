"""What an axis does where it reverses: on a circle, and at a target from both sides."""
