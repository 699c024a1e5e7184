"""Comparisons and evaluations of a table: jobs started, followed and answered over REST."""
