"""Reader of glTF 2.0, its extensions, materials and skins."""
