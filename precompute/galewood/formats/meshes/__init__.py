"""Readers of OBJ, PLY and STL, and of what assimp reads (FBX, COLLADA, 3DS)."""
