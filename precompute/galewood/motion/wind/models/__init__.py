"""Gust models."""
