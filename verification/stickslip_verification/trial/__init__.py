"""What an FMU and the reference do when they are tried, in processes of their own."""
