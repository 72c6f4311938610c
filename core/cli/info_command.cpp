#include <fmt/format.h>

#include <memory>

#include "core/bake/cell_table.h"
#include "core/base/text.h"
#include "core/cli/commands.h"
#include "core/cli/load_options.h"
#include "core/formats/cells_file.h"
#include "core/formats/load_scene.h"
#include "core/io/file_io.h"
#include "core/pvs/param_table.h"
#include "core/pvs/pvs_sections.h"
#include "core/pvs/pvs_writer.h"
#include "core/scene/median_edge.h"
#include "core/voxel/voxel_file.h"

namespace sightline {
namespace {

/// Objects that `info` lists before it says how many more there are.
constexpr size_t kListedObjects = 20;

void row(const std::string& name, const std::string& value) {
  std::fputs(fmt::format("{:<16} {}\n", name, value).c_str(), stdout);
}

std::string point(const glm::dvec3& p) {
  return fmt::format("({:g}, {:g}, {:g})", p.x, p.y, p.z);
}

/// With digits for large numbers.
std::string farPoint(const glm::dvec3& p) {
  return fmt::format("({:.12g}, {:.12g}, {:.12g})", p.x, p.y, p.z);
}

std::string cellLine(const ViewCell& cell) {
  std::string line = fmt::format("center {}  size {}", point(cell.center), point(cell.size));
  if (cell.rotation != glm::dvec3(0.0)) line += "  rotation " + point(cell.rotation);
  return line + (cell.flat() ? "  flat" : "");
}

bool isPvs(const std::filesystem::path& file) {
  const std::string extension = lowerExtension(file);
  return beginsWith(file, kPvsMagic) || extension == ".pvs" || extension == ".part";
}

/// Whether a scene looks as if its unit were a millimetre: larger than a kilometre in metres, of parts larger
/// than rooms. (A hint: terrain may be so too.)
bool looksLikeMillimetres(const glm::dvec3& extent, double median_edge) {
  constexpr double kSmallest = 1'000, kLargest = 1'000'000, kSmallestEdge = 20;
  const double longest = std::max({extent.x, extent.y, extent.z});
  return longest >= kSmallest && longest <= kLargest && median_edge >= kSmallestEdge;
}

/// Where the scene lies, in its file's coordinates, and how large it and its detail are.
void showSize(const Scene& scene) {
  const Bounds bounds = sceneBounds(scene);
  const glm::dvec3 extent = glm::dvec3(bounds.high) - glm::dvec3(bounds.low);
  const double median_edge = medianEdge(scene);
  if (scene.offset == glm::dvec3(0.0)) {
    row("bounds", point(bounds.low) + " to " + point(bounds.high));
  } else {
    row("bounds", farPoint(glm::dvec3(bounds.low) + scene.offset) + " to " +
                      farPoint(glm::dvec3(bounds.high) + scene.offset));
    row("offset", farPoint(scene.offset) + ", taken off: single precision would lose detail there");
  }
  row("extent",
      fmt::format("{:g} x {:g} x {:g}, median edge {:g}", extent.x, extent.y, extent.z, median_edge));
  if (looksLikeMillimetres(extent, median_edge)) {
    row("hint", "looks like millimetres: then sizes of cells are millimetres too");
  }
}

void showScene(const std::filesystem::path& file, const SceneLoadOptions& options) {
  const Scene scene = loadScene(file, options);
  row("scene", file.string());
  row("triangles", std::to_string(scene.triangleCount()));
  if (scene.hasInstances()) {
    row("instances", fmt::format("{} of {} meshes; {} triangles are stored", scene.instances.size(),
                                 scene.meshes.size(), scene.triangles.size()));
  }
  row("vertices", std::to_string(scene.vertexCount()));
  showSize(scene);
  row("degenerate",
      fmt::format("{} triangles without area (kept, cannot be seen)", scene.degenerate_triangles));
  if (options.repair) row("repaired", fmt::format("{} triangles dropped", scene.repaired_triangles));
  if (scene.alpha_triangles != 0) row("alpha", fmt::format("{} triangles", scene.alpha_triangles));
  if (scene.glass_triangles != 0) row("glass", fmt::format("{} triangles", scene.glass_triangles));
  if (scene.single_sided_triangles != 0) {
    row("single-sided", fmt::format("{} triangles", scene.single_sided_triangles));
  }
  const SurfaceCounts surfaces = countSurfaces(scene);
  if (!scene.surfaces.empty()) {
    row("surfaces", fmt::format("{} triangles with holes, {} seen through, {} not there from behind",
                                surfaces.masked, surfaces.glass, surfaces.front_only));
  }
  for (const std::string& warning : scene.warnings) row("warning", warning);
  row("hash", hashText(hashScene(scene)));
  row("objects", std::to_string(scene.objects.size()));
  for (size_t i = 0; i < std::min(scene.objects.size(), kListedObjects); ++i) {
    const SceneObject& object = scene.objects[i];
    row("", fmt::format("{} (from triangle {}, {} of them)", object.name, object.first_triangle,
                        object.triangle_count));
  }
  if (scene.objects.size() > kListedObjects) {
    row("", fmt::format("... and {} more", scene.objects.size() - kListedObjects));
  }
}

void showCells(const std::filesystem::path& file) {
  const std::vector<ViewCell> cells = loadCells(file);
  row("cells", fmt::format("{} in {}", cells.size(), file.string()));
  for (const ViewCell& cell : cells) row(cell.name, cellLine(cell));
}

/// A row a group, with the parameters' names in JSON and options.
void showParams(const BakeParams& params) {
  for (const ParamGroup group : kParamGroups) {
    const std::string row_name = paramGroupName(group);
    std::vector<std::string> values;
    for (const Param& param : kParams) {
      if (param.group != group) continue;
      const std::string value = shownText(param, params);
      values.push_back(row_name == param.name ? value : fmt::format("{} {}", param.name, value));
    }
    row(row_name, fmt::format("{}", fmt::join(values, ", ")));
  }
}

void showPvs(const std::filesystem::path& file) {
  const PvsFile pvs = loadFinishedCells(file);
  const auto cells = summarize(pvs);
  row("visible sets", fmt::format("{}, format version {}", file.string(), pvs.version));
  row("scene",
      fmt::format("{}, {} triangles, hash {}", pvs.scene_name, pvs.triangle_count, hashText(pvs.scene_hash)));
  if (pvs.offset != glm::dvec3(0.0)) row("offset", farPoint(pvs.offset) + ", taken off coordinates");
  row("device", pvs.device);
  row("algorithm", fmt::format("revision {}{}", pvs.algorithm,
                               pvs.intersector.empty() ? "" : ", intersection test of " + pvs.intersector));
  showParams(pvs.params);
  row("witnesses", pvs.has_witnesses ? "yes" : "no");
  for (const NamedTriangles& object : pvs.see_through) {
    row("hides nothing",
        fmt::format("{} (from triangle {}, {} of them)", object.name, object.first, object.count));
  }
  for (const NamedTriangles& door : pvs.doors) {
    row("door", fmt::format("{} (from triangle {}, {} of them)", door.name, door.first, door.count));
  }
  row("result hash", hashText(hashResult(cells)));
  row("cells", fmt::format("{} of {} baked", cells.size(), pvs.planned.size()));
  for (const CellSummary& cell : cells) {
    if (cell.open_stats) row("opened", fmt::format("{}: {} more triangles", cell.cell.name, cell.open_added));
  }
  std::fputs(("\n" + cellTable(cells, pvs.triangle_count)).c_str(), stdout);
}

void showVoxels(const std::filesystem::path& file) {
  const VoxelFile voxels = loadVoxels(file);
  const VoxelHead& head = voxels.head;
  row("voxels", fmt::format("{}, format version {}", file.string(), kVoxelVersion));
  row("scene", fmt::format("{} triangles, hash {}", head.triangle_count, hashText(head.scene_hash)));
  if (head.offset != glm::dvec3(0.0)) row("offset", farPoint(head.offset) + ", taken off coordinates");
  row("voxel", fmt::format("{:g}", head.lattice.voxelSize()));
  const VoxelBox box = boxOf(voxels.levels.front());
  const double size = head.lattice.voxelSize();
  row("bounds", farPoint(glm::dvec3(box.low) * size + head.offset) + " to " +
                    farPoint(glm::dvec3(box.high + 1) * size + head.offset));
  row("voxels are", head.separation == Separation::kConservative ? "all that a triangle meets"
                    : head.separation == Separation::k26         ? "those of a 26-separating set"
                                                                 : "those of a 6-separating set");
  if (head.is_solid) row("solids", "what is inside of them is in the set, too");
  row("blocks have", fmt::format("{}{}{}", head.has_triangles ? "ids of triangles" : "no ids",
                                 head.has_normals ? ", normals" : "", head.has_objects ? ", objects" : ""));
  for (size_t level = 0; level < voxels.levels.size(); ++level) {
    const VoxelGrid& grid = voxels.levels[level];
    row(level == 0 ? "levels" : "",
        fmt::format("{}: {} voxels of {:g} in {}", level, grid.count(), grid.lattice.voxelSize(),
                    counted(grid.blocks.size(), "block")));
  }
}

void runInfo(const std::filesystem::path& file, const SceneLoadOptions& options) {
  if (isPvs(file)) {
    showPvs(file);
  } else if (isVoxelFile(file)) {
    showVoxels(file);
  } else if (lowerExtension(file) == ".json") {
    showCells(file);
  } else {
    showScene(file, options);
  }
}

}  // namespace

void addInfoCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("info", "Say what a scene, cells, .pvs or .slv file holds");
  const auto file = std::make_shared<std::filesystem::path>();
  const auto options = std::make_shared<SceneLoadOptions>();
  command->add_option("file", *file, "scene, cells file, .pvs, .pvs.part or .slv")
      ->required()
      ->type_name("FILE");
  declareLoading(*command, *options, "drop a scene's broken triangles instead of refusing it");
  command->callback([file, options] { runInfo(*file, *options); });
}

}  // namespace sightline
