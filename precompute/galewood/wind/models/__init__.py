"""The models of gusts."""
