#include "core/crosscheck/reproduce.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/error.h"
#include "core/crosscheck/difference.h"
#include "core/device/registry/make_device.h"
#include "core/io/file_io.h"
#include "core/io/float_text.h"
#include "core/judge/seen_triangle.h"
#include "core/scene/scene_tree.h"
#include "core/shared/vector.h"

namespace sightline {
namespace {

/// Triangles of a reproducer at most, but for those that are named.
constexpr size_t kMostTriangles = 4096;
constexpr const char* kNameStart = "disagreement-";

/// Ids that an answer names, ascending.
std::vector<uint32_t> namedTriangles(const Judge& judge, const RayAnswers& answers) {
  std::vector<uint32_t> named = answers.exact.triangles;
  named.insert(named.end(), answers.exact_glass.begin(), answers.exact_glass.end());
  for (const auto& glass : answers.glass) {
    std::ranges::copy_if(glass, std::back_inserter(named),
                         [&](uint32_t triangle) { return triangle < judge.triangleCount(); });
  }
  for (const Hit& hit : answers.hits) {
    if (hit.triangle < judge.triangleCount()) named.push_back(hit.triangle);
  }
  std::sort(named.begin(), named.end());
  named.erase(std::unique(named.begin(), named.end()), named.end());
  return named;
}

/// The distance, in units of the direction, up to which triangles may matter: that of the farthest answer.
/// Who says "nothing" passed all that lies on the whole ray.
double farthestAnswer(const RayAnswers& answers) {
  double farthest = answers.exact.missed() ? HUGE_VAL : answers.exact.t.high;
  for (const Hit& hit : answers.hits) {
    const bool finite = hit.triangle != kNoTriangle && std::isfinite(hit.t);
    farthest = std::max(farthest, finite ? double(hit.t) : HUGE_VAL);
  }
  return farthest;
}

/// The sets of triangles that are tried, each with the named ones.
class Neighbourhood {
 public:
  Neighbourhood(const Judge& judge, const RayAnswers& answers, const RoundingLimit& limit)
      : judge_(judge), ray_(judgeRay(answers.ray)), named_(namedTriangles(judge, answers)) {
    for (const uint32_t triangle : named_) {
      reach_ = std::max(reach_, limit.steps * floatStep(judge, ray_, triangle));
    }
    farthest_ = farthestAnswer(answers);
    steps_ = limit.steps;
  }

  std::vector<std::vector<uint32_t>> sets() const {
    std::vector<uint32_t> close;
    for (const uint32_t triangle : judge_.near(ray_, reach_, farthest_)) {
      const SeenTriangle seen(judge_.corners(triangle), ray_, RayFrame(ray_.direction));
      if (seen.distance() <= steps_ * floatStep(judge_, ray_, triangle)) close.push_back(triangle);
    }
    std::vector<std::vector<uint32_t>> all;
    for (const auto& set :
         {close, judge_.near(ray_, reach_, farthest_), judge_.near(ray_, reach_, HUGE_VAL)}) {
      if (set.size() > kMostTriangles && !all.empty()) break;
      all.push_back(withNamed(set));
    }
    return all;
  }

 private:
  std::vector<uint32_t> withNamed(std::vector<uint32_t> set) const {
    if (set.size() > kMostTriangles) set.resize(kMostTriangles);
    std::vector<uint32_t> merged;
    std::set_union(set.begin(), set.end(), named_.begin(), named_.end(), std::back_inserter(merged));
    return merged;
  }

  const Judge& judge_;
  JudgeRay ray_;
  std::vector<uint32_t> named_;
  double reach_ = 0, farthest_ = 0, steps_ = 0;
};

/// The scene of some of the triangles, with the vertices that they use, and what of them is glass: all that
/// the file of a reproducer can say of surfaces.
Scene partOf(const Scene& scene, std::span<const uint32_t> triangles) {
  Scene part;
  std::map<uint32_t, uint32_t> places;  // of vertices
  for (const uint32_t triangle : triangles) {
    const auto positions = scene.corners(triangle);
    glm::uvec3 corners = scene.vertexNumbers(triangle);
    for (int i = 0; i < 3; ++i) {
      const auto [place, fresh] = places.emplace(corners[i], uint32_t(part.positions.size()));
      if (fresh) part.positions.push_back(positions[size_t(i)]);
      corners[i] = place->second;
    }
    part.triangles.push_back(corners);
    part.surfaces.words.push_back(scene.surfaceOf(triangle) & kSurfaceGlass);
  }
  if (!featuresOf(part.surfaces).glass) part.surfaces.words.clear();
  part.objects = {{"around-the-ray", 0, uint32_t(part.triangles.size())}};
  return part;
}

/// A hit on a part of the scene, in the ids of the whole.
Hit inWhole(Hit hit, std::span<const uint32_t> triangles) {
  if (hit.triangle < triangles.size()) hit.triangle = triangles[hit.triangle];
  return hit;
}

bool sameGlass(const std::vector<uint32_t>& here, const std::vector<uint32_t>& whole,
               std::span<const uint32_t> triangles) {
  return std::ranges::equal(here, whole, {},
                            [&](uint32_t id) { return id < triangles.size() ? triangles[id] : kNoTriangle; });
}

bool sameAnswer(const Hit& a, const Hit& b) {
  if (a.triangle != b.triangle) return false;
  return a.triangle == kNoTriangle || floatBitsToUint(a.t) == floatBitsToUint(b.t);
}

/// One line, whatever stands in names.
std::string oneLine(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  }
  return text;
}

/// A line a device.
std::string answerLines(const ReproducerHead& head, const RayAnswers& answers) {
  std::string text;
  for (size_t d = 0; d < head.devices.size(); ++d) {
    text += fmt::format("# {}: {} ({})\n", head.devices[d], answerText(answers.hits[d], answers.glass[d]),
                        verdictName(answers.rulings[d].verdict));
  }
  return text;
}

bool isReproducer(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  if (name == kMaterialsName) return true;
  return name.starts_with(kNameStart) && name.ends_with(".obj");
}

}  // namespace

Reproducer findReproducer(const Scene& scene, const Judge& judge, const RayAnswers& whole,
                          const DeviceMaker& makeDevice, const RoundingLimit& limit) {
  Reproducer result;
  result.whole = whole;
  for (const std::vector<uint32_t>& triangles : Neighbourhood(judge, whole, limit).sets()) {
    if (triangles == result.triangles) continue;
    result.triangles = triangles;
    result.scene = partOf(scene, triangles);
    const Bvh bvh = buildSceneTree(result.scene);
    std::vector<std::unique_ptr<Tracer>> devices;
    std::vector<Tracer*> pointers;
    for (size_t d = 0; d < whole.hits.size(); ++d) {
      devices.push_back(makeDevice(d, result.scene, bvh));
      pointers.push_back(devices.back().get());
    }
    result.answers = askAll(Judge(result.scene, bvh), whole.ray, pointers, limit);
    result.reproduces = true;
    for (size_t d = 0; d < whole.hits.size(); ++d) {
      const Hit here = inWhole(result.answers.hits[d], triangles);
      result.reproduces = result.reproduces && sameAnswer(here, whole.hits[d]) &&
                          sameGlass(result.answers.glass[d], whole.glass[d], triangles) &&
                          result.answers.rulings[d].verdict == whole.rulings[d].verdict;
    }
    if (result.reproduces) break;
  }
  return result;
}

std::string reproducerText(const ReproducerHead& head, const Reproducer& reproducer) {
  const RayAnswers& answers = reproducer.answers;
  const vec3 origin = xyz3(answers.ray.origin), direction = xyz3(answers.ray.direction);
  const std::string scene_name = oneLine(head.scene_name);
  std::string devices;
  for (const std::string& device : head.devices) devices += (devices.empty() ? "" : ",") + device;
  std::string text = fmt::format("# {}, scene {}\n", oneLine(head.what), scene_name);
  text += fmt::format("# from {} along {}\n", hexText(origin), hexText(direction));
  text += fmt::format("# bits {} along {}\n", bitsText(origin), bitsText(direction));
  text += fmt::format("# exactly: {}\n", exactText(answers.exact, answers.exact_glass));
  text += answerLines(head, answers);
  if (reproducer.reproduces) {
    text += "# On these triangles alone each device answers as on the whole scene.\n";
  } else {
    text +=
        "# These are the answers on these triangles alone, where it does NOT reproduce. On the whole "
        "scene:\n";
    text += fmt::format("# exactly: {}\n{}", exactText(reproducer.whole.exact, reproducer.whole.exact_glass),
                        answerLines(head, reproducer.whole));
  }
  text += fmt::format("# In this folder: sightline trace {} --from {} --along {} --devices {}{}\n",
                      head.file_name, bitsText(origin), bitsText(direction), devices, head.options);
  const Surfaces& surfaces = reproducer.scene.surfaces;
  if (!surfaces.empty()) text += fmt::format("mtllib {}\n", kMaterialsName);
  for (const glm::vec3& p : reproducer.scene.positions) text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
  for (size_t i = 0; i < reproducer.triangles.size(); ++i) {
    const glm::uvec3 t = reproducer.scene.triangles[i] + 1u;
    if (!surfaces.empty()) text += surfaces.words[i] == 0 ? "usemtl opaque\n" : "usemtl glass\n";
    text += fmt::format("# triangle {} here is {} of {}\nf {} {} {}\n", i, reproducer.triangles[i],
                        scene_name, t.x, t.y, t.z);
  }
  return text;
}

std::string materialsText() {
  return "newmtl opaque\nd 1\nnewmtl glass\nd 0.5\n";
}

std::string reproducerName(size_t number) {
  return fmt::format("{}{:04}.obj", kNameStart, number + 1);
}

void prepareReproducerFolder(const std::filesystem::path& folder, bool overwrite,
                             std::span<const std::filesystem::path> inputs) {
  makeFolder(folder);
  std::error_code failure;
  const bool empty = std::filesystem::is_empty(folder, failure);
  if (failure) throw Error(fmt::format("{}: cannot be read: {}", folder.string(), failure.message()));
  if (empty) return;
  if (!overwrite) {
    throw Error(fmt::format("{}: is not empty; name a new folder, or --overwrite the reproducers in it",
                            folder.string()));
  }
  for (const std::filesystem::path& input : inputs) {
    if (!isReproducer(input) || !std::filesystem::equivalent(folder / input.filename(), input, failure))
      continue;
    throw Error(fmt::format("{}: would be overwritten; name another folder", input.string()), kExitUsage);
  }
}

size_t removeReproducers(const std::filesystem::path& folder) {
  std::error_code failure;
  size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failure)) {
    if (isReproducer(entry.path()) && entry.is_regular_file(failure)) {
      count += std::filesystem::remove(entry.path(), failure);
    }
    if (failure) break;
  }
  if (failure) throw Error(fmt::format("{}: cannot be emptied: {}", folder.string(), failure.message()));
  return count;
}

}  // namespace sightline
