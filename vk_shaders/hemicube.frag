#version 460
// Writes which leaf a pixel shows.
layout(location = 0) flat in uint leaf_of_vertex;
layout(location = 0) out uint leaf;

void main() {
  leaf = leaf_of_vertex;
}
