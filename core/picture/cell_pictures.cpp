#include "core/picture/cell_pictures.h"

#include <fmt/core.h>

#include "core/io/file_io.h"

namespace sightline {

std::string pictureName(const std::string& cell_name, uint32_t index) {
  std::string name = fmt::format("{:03}-{}", index, cell_name);
  for (char& c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '.' || (c & 0x80) != 0;
    if (!plain) c = '_';
  }
  return name;
}

double saveCellPictures(const TraceRays& trace, const Scene& scene, const CellPvs& cell, uint32_t index,
                        const std::filesystem::path& folder, const TraceGlass& glass) {
  makeFolder(folder);
  const std::string name = pictureName(cell.cell.name, index);
  savePng(renderOutside(trace, scene, cell, {}, glass).image, folder / (name + "-outside.png"));
  const Picture inside = renderInside(trace, scene, cell, {}, glass);
  savePng(inside.image, folder / (name + "-inside.png"));
  return inside.scene_pixels == 0 ? 0 : double(inside.missing_pixels) / double(inside.scene_pixels);
}

}  // namespace sightline
