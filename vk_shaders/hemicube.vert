#version 460
// The triangles of the scene as a view of a hemicube sees them: three vertices a leaf, without an index.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_multiview : require
#include "vk_shaders/sampling.glsl"

layout(location = 0) flat out uint leaf_of_vertex;
out gl_PerVertex {
  vec4 gl_Position;
  float gl_ClipDistance[1];
};

void main() {
  leaf_of_vertex = uint(gl_VertexIndex) / 3u;
  Buffer_ViewFrame views = Buffer_ViewFrame(SL_THE_LAUNCH.hemicube);
  ViewFrame view = views.at[gl_ViewIndex];
  vec3 corner = sub3(leafCorner(leaf_of_vertex, uint(gl_VertexIndex) % 3u), xyz3(view.origin));
  // Pixel (x, y) shows what viewRay meets. Reversed z without a far plane: depth is near / distance.
  gl_Position = vec4(dot3(corner, xyz3(view.right)), -dot3(corner, xyz3(view.up)), SL_THE_LAUNCH.raster_near,
                     dot3(corner, xyz3(view.forward)));
  // Of the sides only the half in front of the face counts; the rest need not be drawn.
  gl_ClipDistance[0] = dot3(corner, xyz3(views.at[0].forward));
}
