// Prints the ids of the triangles that may be seen from a point, a line each.
//   what_is_seen CITY.pvs X,Y,Z
#include <sightline/pvs/pvs_file.h>
#include <sightline/pvs/visible_from.h>

#include <cstdio>
#include <exception>

int main(int argc, char** argv) {
  glm::dvec3 viewer(0);
  if (argc != 3 || std::sscanf(argv[2], "%lf,%lf,%lf", &viewer.x, &viewer.y, &viewer.z) != 3) {
    std::fputs("usage: what_is_seen FILE.pvs X,Y,Z\n", stderr);
    return 2;
  }
  try {
    const sightline::PvsFile pvs = sightline::loadPvs(argv[1]);
    const auto visible = sightline::visibleFrom(pvs, viewer);
    if (!visible) {
      std::fprintf(stderr, "what_is_seen: no cell contains the point: draw everything\n");
      return 1;
    }
    for (const uint32_t id : *visible) std::printf("%u\n", id);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "what_is_seen: %s\n", error.what());
    return 1;
  }
}
