"""Random lives of instances: what a careless master calls, and what each call must give."""
