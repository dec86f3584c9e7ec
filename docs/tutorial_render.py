"""Renders a mesh and a volume on top of each other.

blender -b --factory-startup -noaudio -P docs/tutorial_render.py -- MESH.obj VOLUME.vdb OUT.png

Both are imported as Blender does by default and stay where they are. The mesh becomes wires; the volume's grid
`density`, fog.
"""

import os
import sys

import bpy
from mathutils import Vector

WIDTH, HEIGHT = 800, 500
SAMPLES = 16
VIEW = Vector((0.3, -1, 0.55)).normalized()  # from the middle of the mesh to the camera
WIRE_COLOR, WIRE_THICKNESS = (0.01, 0.03, 0.08, 1), 0.018
FOG_COLOR, FOG_DENSITY = (1.0, 0.45, 0.12, 1), 12


def empty_material(name):
    """A material without nodes but its output, and that."""
    result = bpy.data.materials.new(name)
    result.use_nodes = True
    result.node_tree.nodes.clear()
    return result, result.node_tree.nodes.new("ShaderNodeOutputMaterial")


def wire_material():
    result, output = empty_material("wires")
    shader = result.node_tree.nodes.new("ShaderNodeEmission")
    shader.inputs["Color"].default_value = WIRE_COLOR
    result.node_tree.links.new(shader.outputs["Emission"], output.inputs["Surface"])
    return result


def fog_material():
    """Fog from where the grid passes 0.5, so that what leaks through holes does not veil the picture.

    It glows instead of scattering light, which needs few samples; where it is deep it has the colour FOG_COLOR.
    """
    result, output = empty_material("fog")
    nodes, links = result.node_tree.nodes, result.node_tree.links
    grid, ramp = nodes.new("ShaderNodeAttribute"), nodes.new("ShaderNodeMapRange")
    shader = nodes.new("ShaderNodeVolumePrincipled")
    grid.attribute_name = "density"
    ramp.inputs["From Min"].default_value, ramp.inputs["From Max"].default_value = 0.45, 0.55
    ramp.inputs["To Max"].default_value = FOG_DENSITY
    shader.inputs["Color"].default_value = (0, 0, 0, 1)
    shader.inputs["Emission Color"].default_value = FOG_COLOR
    shader.inputs["Density Attribute"].default_value = ""
    links.new(grid.outputs["Fac"], ramp.inputs["Value"])
    links.new(ramp.outputs["Result"], shader.inputs["Density"])
    links.new(ramp.outputs["Result"], shader.inputs["Emission Strength"])
    links.new(shader.outputs["Volume"], output.inputs["Volume"])
    return result


def import_mesh(path):
    bpy.ops.wm.obj_import(filepath=path)
    mesh = bpy.context.selected_objects[0]
    wires = mesh.modifiers.new("wires", "WIREFRAME")
    wires.thickness = WIRE_THICKNESS
    wires.use_even_offset = False  # no spikes at sharp corners
    mesh.data.materials.clear()
    mesh.data.materials.append(wire_material())
    return mesh


def import_volume(path):
    bpy.ops.object.volume_import(filepath=path)
    bpy.context.object.data.materials.append(fog_material())


def positions(mesh):
    bpy.context.view_layer.update()
    return [mesh.matrix_world @ vertex.co for vertex in mesh.data.vertices]


def add_camera(points):
    """A camera from the direction VIEW that sees all points, with a margin."""
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    bpy.context.collection.objects.link(camera)
    camera.rotation_euler = VIEW.to_track_quat("Z", "Y").to_euler()
    bpy.context.scene.camera = camera
    bpy.context.view_layer.update()
    middle = sum(points, Vector()) / len(points)
    spread = [middle + 1.05 * (point - middle) for point in points]
    depsgraph = bpy.context.evaluated_depsgraph_get()
    camera.location, _ = camera.camera_fit_coords(depsgraph, [value for point in spread for value in point])


def render(path):
    scene = bpy.context.scene
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    scene.render.engine = "CYCLES"
    scene.cycles.samples = SAMPLES
    scene.cycles.volume_step_rate = 4  # fog without detail needs no more steps
    scene.cycles.use_denoising = False  # not in every build
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.render.image_settings.color_mode = "RGB"
    scene.render.image_settings.compression = 100
    scene.render.filepath = os.path.abspath(path)
    bpy.ops.render.render(write_still=True)


def main(mesh_path, volume_path, picture_path):
    for startup_object in list(bpy.data.objects):
        bpy.data.objects.remove(startup_object)
    points = positions(import_mesh(os.path.abspath(mesh_path)))
    import_volume(os.path.abspath(volume_path))
    add_camera(points)
    render(picture_path)


main(*sys.argv[sys.argv.index("--") + 1 :])
