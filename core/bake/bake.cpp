#include "core/bake/bake.h"

#include <fmt/core.h>

#include "core/base/error.h"
#include "core/base/interrupted.h"
#include "core/cell/cell_problem.h"
#include "core/io/file_io.h"
#include "core/pvs/param_table.h"
#include "core/pvs/pvs_sections.h"

namespace sightline {
namespace {

template <typename T>
void compare(std::vector<std::string>& differences, const char* name, const T& earlier, const T& wanted) {
  if (earlier == wanted) return;
  differences.push_back(fmt::format("{} ({} there, {} now)", name, earlier, wanted));
}

void compareCells(std::vector<std::string>& differences, const std::vector<ViewCell>& earlier,
                  const std::vector<ViewCell>& wanted) {
  compare(differences, "number of cells", earlier.size(), wanted.size());
  for (size_t i = 0; i < std::min(earlier.size(), wanted.size()); ++i) {
    if (earlier[i] == wanted[i]) continue;
    differences.push_back(fmt::format("cell {} ({} there, {} now{})", i, earlier[i].name, wanted[i].name,
                                      earlier[i].name == wanted[i].name ? ", of another shape" : ""));
    return;
  }
}

/// What there is to do about a bake that is in the way.
constexpr const char* kRemedy = "choose another -o, or --overwrite it";

/// In one line how the bake in `file` differs from the one wanted; empty: in nothing.
std::string whyOther(const PvsFile& earlier, const PvsFile& wanted, const std::filesystem::path& file) {
  const auto differences = inputDifferences(earlier, wanted);
  if (differences.empty()) return {};
  std::string list = differences.front();
  for (size_t i = 1; i < differences.size(); ++i) list += ", " + differences[i];
  return fmt::format("{}: holds a bake with other inputs: {}; {}", file.string(), list, kRemedy);
}

/// What `load` reads of an earlier bake's file. Throws BadPvs that says how to do without, or Error if the
/// file cannot be read.
template <typename Load>
auto loadEarlier(Load load, const std::filesystem::path& file) {
  try {
    return load(file);
  } catch (const BadPvs& problem) {
    throw BadPvs(fmt::format("{} ({})", problem.what(), kRemedy));
  }
}

std::string namesText(const std::vector<NamedTriangles>& objects) {
  std::string names;
  for (const NamedTriangles& object : objects) names += (names.empty() ? "" : ", ") + object.name;
  return names.empty() ? "none" : names;
}

void compareObjects(std::vector<std::string>& differences, const char* what,
                    const std::vector<NamedTriangles>& earlier, const std::vector<NamedTriangles>& wanted) {
  const std::string there = namesText(earlier), now = namesText(wanted);
  compare(differences, what, there, now);
  if (there == now && earlier != wanted) {
    differences.push_back(fmt::format("{} (of the same names, but of other triangles)", what));
  }
}

std::string intersectorText(const std::string& intersector) {
  return intersector.empty() ? "that of cpu and opencl" : "that of " + intersector;
}

}  // namespace

std::vector<std::string> inputDifferences(const PvsFile& earlier, const PvsFile& wanted) {
  std::vector<std::string> differences;
  // What the later versions add is compared by itself, so only what the program no longer writes differs.
  const auto formatOf = [](const PvsFile& pvs) { return std::min(pvs.version, kPvsVersionWithCosts); };
  compare(differences, "version of the format", formatOf(earlier), formatOf(wanted));
  compare(differences, "revision of the algorithm", earlier.algorithm, wanted.algorithm);
  compare(differences, "intersection test", intersectorText(earlier.intersector),
          intersectorText(wanted.intersector));
  if (earlier.scene_hash != wanted.scene_hash || earlier.triangle_count != wanted.triangle_count) {
    differences.push_back(fmt::format("scene ({} with {} triangles there, {} with {} now)",
                                      earlier.scene_name, earlier.triangle_count, wanted.scene_name,
                                      wanted.triangle_count));
  }
  compareCells(differences, earlier.planned, wanted.planned);
  for (const Param& param : kParams) {
    if (sameValue(param, earlier.params, wanted.params)) continue;
    compare(differences, param.name, valueText(param, earlier.params), valueText(param, wanted.params));
  }
  compare(differences, "witnesses", earlier.has_witnesses, wanted.has_witnesses);
  compareObjects(differences, "doors", earlier.doors, wanted.doors);
  compareObjects(differences, "objects that hide nothing", earlier.see_through, wanted.see_through);
  return differences;
}

std::filesystem::path partFileOf(std::filesystem::path file) {
  file += ".part";
  return file;
}

Bake::Bake(PvsFile wanted, std::filesystem::path file, bool overwrite)
    : head_(std::move(wanted)), file_(std::move(file)), part_(partFileOf(file_)) {
  head_.cells.clear();
  if (const auto problem = cellProblem(head_.planned)) throw Error(problem->text(), kExitUsage);
  if (file_.empty()) throw Error("the output has no name; name a file to write", kExitUsage);
  if (std::filesystem::is_directory(file_)) {
    throw Error(fmt::format("{}: is a folder; name a file to write", file_.string()));
  }
  requireReplaceable(file_);
  requireReplaceable(part_);
  if (!overwrite && openComplete()) return;
  writer_ = std::make_unique<PvsWriter>(part_);
  goOnAfterPart(overwrite);
}

bool Bake::openComplete() {
  if (!std::filesystem::exists(file_)) return false;
  const PvsFile earlier = loadEarlier(loadPvs, file_);
  if (const std::string why = whyOther(earlier, head_, file_); !why.empty()) throw Error(why);
  if (earlier.cells.size() != earlier.planned.size()) {
    throw Error(
        fmt::format("{}: holds {} of {} cells, which a bake would replace; choose another -o, or "
                    "--overwrite it",
                    file_.string(), earlier.cells.size(), earlier.planned.size()));
  }
  finished_ = summarize(earlier);
  resumed_ = finished_.size();
  head_.device = earlier.device;
  complete_ = true;
  return true;
}

void Bake::goOnAfterPart(bool overwrite) {
  PartialPvs left;
  try {
    left = loadEarlier(loadPartialPvs, part_);
  } catch (const BadPvs&) {
    if (!overwrite) throw;  // else it goes; what cannot even be read stays
    return;
  }
  if (left.pvs.cells.empty()) {  // nothing that would be lost, whatever its inputs
    part_problem_ = left.problem;
    return;
  }
  const std::string why = whyOther(left.pvs, head_, part_);
  if (!why.empty() && !overwrite) throw Error(why);
  if (!why.empty()) return;
  part_problem_ = left.problem;
  writer_->goOn(left);
  begun_ = true;
  finished_ = summarize(left.pvs);
  resumed_ = finished_.size();
  head_.device = left.pvs.device;
}

bool Bake::run(const std::string& device, const CellBaker& baker, const BakeEvents& events) {
  if (complete_) return true;
  if (finished_.empty()) head_.device = device;
  if (!begun_) {
    writer_->begin(head_);
    begun_ = true;
  }
  while (finished_.size() < head_.planned.size()) {
    const auto index = uint32_t(finished_.size());
    if (events.stop && *events.stop) return false;
    try {
      CellPvs pvs = baker(head_.planned[index], index, [&](const BakeProgress& progress) {
        if (events.progress) events.progress(index, progress);
      });
      pvs.device = device;
      writer_->append(pvs);
      finished_.push_back(summarize(pvs));
      if (events.cell_done) events.cell_done(index, pvs);
    } catch (const Interrupted&) {
      return false;
    }
  }
  writer_->finish(file_);
  complete_ = true;
  return true;
}

}  // namespace sightline
