#include <cmath>

#include "core/formats/cells_file.h"
#include "tests/fuzz/check.h"

namespace sightline::fuzz {
namespace {

void requireUsable(const ViewCell& cell) {
  const std::vector<Face> faces = cellFaces(cell);
  require(!faces.empty(), "a cell without faces");
  for (const Face& face : faces) {
    for (const glm::vec4& vector : {face.corner, face.edge_u, face.edge_v}) {
      for (int axis = 0; axis < 3; ++axis) require(std::isfinite(vector[axis]), "a face that is not finite");
    }
    require(glm::length(glm::dvec3(face.edge_u)) > 0 && glm::length(glm::dvec3(face.edge_v)) > 0,
            "a face without area");
  }
}

void check(std::string_view text) {
  expectLine("c.json", [&] {
    const std::vector<ViewCell> cells = parseCells(text, "c.json");
    require(!cells.empty(), "no cells");
    for (const ViewCell& cell : cells) requireUsable(cell);
    require(parseCells(cellsText(cells, "c.json"), "c.json") == cells,
            "other cells after writing and reading");
  });
}

}  // namespace
}  // namespace sightline::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  sightline::fuzz::check(sightline::fuzz::fileBytes(data, size).view());
  return 0;
}
