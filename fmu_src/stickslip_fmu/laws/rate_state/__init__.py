"""Rate and state: friction of contacts that age and slide."""
