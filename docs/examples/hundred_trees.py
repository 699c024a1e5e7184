"""From a mesh to the bent vertices of a hundred trees."""

import galewood

tree = galewood.read("oak.glb", height_m=12)
table = galewood.build(tree, on_progress=lambda now: print(f"{now.fraction:4.0%} {now.message}"))
galewood.save(table, "oak.gwt")
wind = galewood.Wind(mean_speed_m_s=12, direction_deg=30, gustiness=0.5)
forest = galewood.Forest([table], galewood.grid(100), wind)
for _ in range(90):
    forest.step(1 / 30)
vertices_m = [forest.vertices_m(tree=k) for k in range(100)]
