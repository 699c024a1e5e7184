"""Comparisons and evaluations of tables against their finite element model."""
