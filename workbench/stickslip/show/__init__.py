"""Tables and plots of runs, verdicts and scores."""
