// Bakes a scene's view cells, writes the sets, and says what may be seen from a point.
//   bake_and_ask SCENE CELLS.json OUT.pvs DEVICE X,Y,Z
#include <sightline/api/bake.h>
#include <sightline/api/session.h>
#include <sightline/formats/cells_file.h>
#include <sightline/formats/load_scene.h>
#include <sightline/pvs/visible_from.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <utility>

namespace {

int bakeAndAsk(const char* scene_file, const char* cells_file, const char* pvs_file, const char* device,
               const glm::dvec3& viewer) {
  sightline::SessionOptions options;
  options.device = device;
  options.scene_name = std::filesystem::path(scene_file).filename().string();
  sightline::Session session(sightline::loadScene(scene_file), options);

  sightline::BakeParams params;
  params.n_rand = 100'000;  // small, for a small scene
  params.validation_rays = 100'000;
  sightline::BakeEvents events;
  events.cell_done = [](uint32_t, const sightline::CellPvs& cell) {
    std::printf("%s: %zu triangles\n", cell.cell.name.c_str(), cell.triangles.size());
  };
  const sightline::PvsFile pvs = sightline::bake(session, sightline::loadCells(cells_file), params, events);
  sightline::savePvs(pvs, pvs_file);

  const auto visible = sightline::visibleFrom(pvs, viewer);
  if (!visible) {
    std::printf("no cell contains the point: draw everything\n");
  } else {
    std::printf("%zu of %u triangles may be seen\n", visible->size(), pvs.triangle_count);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  glm::dvec3 viewer(0);
  if (argc != 6 || std::sscanf(argv[5], "%lf,%lf,%lf", &viewer.x, &viewer.y, &viewer.z) != 3) {
    std::fputs("usage: bake_and_ask SCENE CELLS.json OUT.pvs DEVICE X,Y,Z\n", stderr);
    return 2;
  }
  try {
    return bakeAndAsk(argv[1], argv[2], argv[3], argv[4], viewer);
  } catch (const std::exception& error) {  // sightline::Error, std::bad_alloc
    std::fprintf(stderr, "bake_and_ask: %s\n", error.what());
    return 1;
  }
}
