"""What Blender sees of volumes and meshes, as one line of JSON: blender -b --factory-startup -noaudio -P
blender_import.py -- FILE...

Of each file its bounding box in the world, by the importers and their defaults that users get from the menu; of a .vdb
the names of its grids too, of a .ply how many corners of faces have which colour.
"""

import collections
import json
import sys

import bpy
from mathutils import Vector


def box_of(thing):
    corners = [thing.matrix_world @ Vector(corner) for corner in thing.bound_box]
    return [[choose(corner[axis] for corner in corners) for axis in range(3)] for choose in (min, max)]


def seen(path):
    if path.endswith(".vdb"):
        bpy.ops.object.volume_import(filepath=path)
        grids = bpy.context.object.data.grids
        grids.load()
        bpy.context.view_layer.update()
        return {"grids": {grid.name: grid.data_type for grid in grids}, "box": box_of(bpy.context.object)}
    if path.endswith(".ply"):
        import_ply = bpy.ops.wm.ply_import if bpy.app.version >= (4, 0, 0) else bpy.ops.import_mesh.ply
        import_ply(filepath=path)
        colours = bpy.context.object.data.color_attributes["Col"].data
        names = (" ".join(str(round(255 * part)) for part in colour.color_srgb[:3]) for colour in colours)
        return {"colours": collections.Counter(names), "box": box_of(bpy.context.object)}
    bpy.ops.wm.obj_import(filepath=path)
    return {"box": box_of(bpy.context.object)}


print(json.dumps({path: seen(path) for path in sys.argv[sys.argv.index("--") + 1 :]}))
