"""Uploads over REST: a mesh becomes a tree, whose pieces can be chosen and import options changed."""
