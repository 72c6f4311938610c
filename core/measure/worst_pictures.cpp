#include "core/measure/worst_pictures.h"

#include <fmt/core.h>

#include <regex>

#include "core/base/error.h"
#include "core/picture/cell_pictures.h"
#include "core/picture/shading.h"
#include "core/picture/view_picture.h"

namespace sightline {
namespace {

/// What the pixels of a view see through.
std::vector<SeenThrough> glassOf(Tracer& tracer, const ViewFrame& frame, uint32_t resolution) {
  if (!tracer.hasGlass()) return {};
  std::vector<Ray> rays;
  for (uint32_t y = 0; y < resolution; ++y) {
    for (uint32_t x = 0; x < resolution; ++x) rays.push_back(viewRay(frame, x, y, resolution));
  }
  std::vector<Hit> hits(rays.size());
  tracer.traceRays(rays, hits);
  return tracer.traceGlass(rays, hits);
}

}  // namespace

std::vector<std::string> WorstPictures::draw(const Scene& scene, Tracer& tracer, const CellPvs& pvs,
                                             uint32_t cell_index, size_t set,
                                             std::span<const uint32_t> views) const {
  const std::vector<uint8_t> member = membership(scene, pvs.triangles);
  const auto frames = measureViews(pvs.cell, cell_index, options.views, options.seed, options.fov);
  std::vector<uint32_t> triangles(size_t(options.resolution) * options.resolution);
  std::vector<std::string> names;
  for (const uint32_t view : views) {
    const std::string of_set = alone ? "" : fmt::format("-{}", set);
    names.push_back(fmt::format("{}{}-view-{}.png", pictureName(pvs.cell.name, cell_index), of_set, view));
    tracer.traceViews(std::span(frames).subspan(view, 1), options.resolution, triangles);
    const std::vector<SeenThrough> glass = glassOf(tracer, frames[view], options.resolution);
    savePng(viewPicture(scene, frames[view], options.resolution, triangles, glass, member),
            folder / names.back());
  }
  return names;
}

size_t removeWorstPictures(const std::filesystem::path& folder, const std::string& cell,
                           uint32_t cell_index) {
  static const std::regex kRest("(-[0-9]+)?-view-[0-9]+\\.png");
  const std::string start = pictureName(cell, cell_index);
  std::vector<std::filesystem::path> old;
  std::error_code problem;
  for (const auto& entry : std::filesystem::directory_iterator(folder, problem)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(start) || !std::regex_match(name.substr(start.size()), kRest)) continue;
    std::error_code ignored;
    if (entry.is_regular_file(ignored)) old.push_back(entry.path());
  }
  if (problem)
    throw Error(fmt::format("{}: cannot read this folder: {}", folder.string(), problem.message()));
  for (const std::filesystem::path& file : old) {
    std::filesystem::remove(file, problem);
    if (!problem) continue;
    throw Error(fmt::format("{}: cannot remove this picture of an earlier measurement: {}", file.string(),
                            problem.message()));
  }
  return old.size();
}

}  // namespace sightline
