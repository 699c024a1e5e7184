"""Files over REST: tables, meshes, thumbnails and pictures of a build."""
