"""Draw an exported USD stage in Blender: PYTHON inBlender.py STAGE.usdc FRAME HEIGHT_M PICTURE.png.

PYTHON is one with the package bpy, which is Blender itself. It is none of this repository's packages.
"""
# pyright: basic, reportMissingImports=false

import math
import sys

import bpy

stage, frame, height_m, picture = sys.argv[1], int(sys.argv[2]), float(sys.argv[3]), sys.argv[4]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.usd_import(filepath=stage)
scene = bpy.context.scene
scene.frame_set(frame)
world = scene.world = bpy.data.worlds.new("sky")
world.use_nodes = True
world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.67, 0.82, 1.0)
sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
sun.data.energy, sun.rotation_euler = 4.0, (math.radians(40), math.radians(20), 0.0)
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
camera.location, camera.rotation_euler = (0.0, -2.2 * height_m, 0.47 * height_m), (math.pi / 2, 0.0, 0.0)
camera.data.sensor_fit, camera.data.angle = "VERTICAL", math.radians(30)
for one in (sun, camera):
    scene.collection.objects.link(one)
scene.camera = camera
scene.render.engine = "CYCLES"
scene.cycles.device, scene.cycles.samples = "CPU", 24
scene.view_settings.view_transform = "Standard"
scene.render.resolution_x, scene.render.resolution_y = 320, 380
scene.render.filepath = picture
bpy.ops.render.render(write_still=True)
