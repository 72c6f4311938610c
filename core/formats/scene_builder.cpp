#include "core/formats/scene_builder.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/scene/instances.h"
#include "core/scene/precision_warning.h"
#include "core/scene/triangle_area.h"

namespace sightline {
namespace {

/// Bad vertices whose places are kept for messages: they may be all of a file, and faces that use one come
/// mostly soon.
constexpr size_t kBadPlaces = 1000;

/// False for NaN too.
bool isInRange(const glm::vec3& v) {
  return std::abs(v.x) <= kLargestCoordinate && std::abs(v.y) <= kLargestCoordinate &&
         std::abs(v.z) <= kLargestCoordinate;
}

/// Length of the UTF-8 sequence at the start of the text, 0 if it is not one (RFC 3629).
size_t utf8Length(std::string_view text) {
  const auto byte = [&](size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const auto continues = [&](size_t i) { return (byte(i) & 0xc0u) == 0x80u; };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first <= 0xdf) return continues(1) ? 2 : 0;
  if (first >= 0xe0 && first <= 0xef) {
    if (!continues(1) || !continues(2)) return 0;
    const bool overlong = first == 0xe0 && byte(1) < 0xa0;
    const bool surrogate = first == 0xed && byte(1) >= 0xa0;
    return overlong || surrogate ? 0 : 3;
  }
  if (first >= 0xf0 && first <= 0xf4) {
    if (!continues(1) || !continues(2) || !continues(3)) return 0;
    const bool out_of_range = (first == 0xf0 && byte(1) < 0x90) || (first == 0xf4 && byte(1) >= 0x90);
    return out_of_range ? 0 : 4;
  }
  return 0;
}

uint64_t countDegenerate(const Scene& scene) {
  return tbb::parallel_reduce(
      tbb::blocked_range<uint32_t>(0, scene.triangleCount(), 1 << 16), uint64_t(0),
      [&](const tbb::blocked_range<uint32_t>& range, uint64_t count) {
        scene.visitTriangles(range.begin(), range.end(), [&](uint32_t, const auto& t) {
          if (hasZeroArea(t[0], t[1], t[2])) ++count;
        });
        return count;
      },
      std::plus<>());
}

}  // namespace

std::string cleanName(std::string_view name) {
  std::string result;
  while (!name.empty()) {
    const size_t length = utf8Length(name);
    const auto first = static_cast<unsigned char>(name[0]);
    const bool control = first < 0x20 || first == 0x7f;
    if (length == 0 || control) {
      result += first == '\t' ? ' ' : '_';
    } else {
      result += name.substr(0, length);
    }
    name.remove_prefix(std::max<size_t>(length, 1));
  }
  const size_t begin = result.find_first_not_of(' ');
  if (begin == std::string::npos) return {};
  return result.substr(begin, result.find_last_not_of(' ') - begin + 1);
}

void SceneBuilder::addPosition(const glm::vec3& position, const glm::dvec3& full, const Place& place) {
  if (scene_.offset == glm::dvec3(0.0)) {
    add(position, full, place);
  } else {
    addPlaced(full - scene_.offset, place);
  }
}

void SceneBuilder::addPlaced(const glm::dvec3& position, const Place& place) {
  if (scene_.offset != glm::dvec3(0.0)) {
    const glm::dvec3 in_file = position + scene_.offset;
    file_has_floats_ = file_has_floats_ && in_file == glm::dvec3(glm::vec3(in_file));
  }
  add(glm::vec3(position), position, place);
}

void SceneBuilder::add(const glm::vec3& position, const glm::dvec3& full, const Place& place) {
  if (scene_.positions.size() >= kMaxElements) throw Error(fmt::format("{}: too many vertices", place()));
  if (isInRange(position)) {
    const glm::vec3 remainder(full - glm::dvec3(position));
    if (remainder != glm::vec3(0.0f)) {
      remainders_.resize(scene_.positions.size(), glm::vec3(0.0f));
      remainders_.push_back(remainder);
    }
    scene_.positions.push_back(position);
    return;
  }
  if (bad_vertices_.size() < kBadPlaces && !repair_) bad_places_.push_back(place());
  bad_vertices_.emplace_back(uint32_t(scene_.positions.size()), position);
  scene_.positions.emplace_back(0.0f);
}

std::optional<size_t> SceneBuilder::badVertex(int64_t index) const {
  const auto found = std::lower_bound(bad_vertices_.begin(), bad_vertices_.end(), index,
                                      [](const auto& bad, int64_t wanted) { return bad.first < wanted; });
  if (found == bad_vertices_.end() || found->first != index) return std::nullopt;
  return size_t(found - bad_vertices_.begin());
}

void SceneBuilder::failAtBadVertex(size_t bad, const Place& face) const {
  const glm::vec3& position = bad_vertices_[bad].second;
  const bool finite = std::isfinite(position.x) && std::isfinite(position.y) && std::isfinite(position.z);
  throw Error(fmt::format(
      "{}: vertex ({}, {}, {}) is {}; --repair drops its triangles",
      bad < bad_places_.size() ? bad_places_[bad] : face(), position.x, position.y, position.z,
      finite ? "farther than 2^40 from the origin, too far to trace: scale the scene" : "not finite"));
}

void SceneBuilder::closeObject() {
  const auto end = uint32_t(triangleCount());
  object_.triangle_count = end - object_.first_triangle;
  if (object_.triangle_count != 0) scene_.objects.push_back(object_);
  object_.first_triangle = end;
}

void SceneBuilder::beginObject(std::string_view name, const std::string& fallback,
                               const std::optional<GltfPart>& part) {
  closeObject();
  object_.part = part;
  object_.name = cleanName(name);
  if (object_.name.empty()) object_.name = fallback;
}

bool SceneBuilder::usable(std::span<const int64_t> corners, const VertexRange& vertices,
                          const Place& place) const {
  if (corners.size() < 3) {
    if (repair_) return false;
    throw Error(fmt::format("{}: face has {} vertices, needs at least 3; --repair drops it", place(),
                            corners.size()));
  }
  for (const int64_t corner : corners) {
    const bool in_range = corner >= 0 && corner < vertices.count;
    const std::optional<size_t> bad = in_range ? badVertex(vertices.first + corner) : std::nullopt;
    if (in_range && !bad) continue;
    if (repair_) return false;
    if (bad) failAtBadVertex(*bad, place);
    if (vertices.count == 0) throw Error(fmt::format("{}: face without any vertex in the file", place()));
    throw Error(fmt::format("{}: vertex index {} is out of range {}..{}; --repair drops the face", place(),
                            corner + vertices.number_of_first, vertices.number_of_first,
                            vertices.count - 1 + vertices.number_of_first));
  }
  return true;
}

void SceneBuilder::addTriangle(const glm::uvec3& triangle, const Place& place) {
  if (scene_.triangles.size() >= kMaxElements) throw Error(fmt::format("{}: too many triangles", place()));
  scene_.triangles.push_back(triangle);
  if (faces_) scene_.faces.push_back(face_);
  if (surface_ != 0) surfaceOfLast(surface_);
}

void SceneBuilder::surfaceOfLast(uint32_t word) {
  std::vector<uint32_t>& words = scene_.surfaces.words;
  words.resize(scene_.triangles.size(), 0u);
  words.back() = word;
}

void SceneBuilder::addToSurfaces(uint64_t first, uint64_t count, uint32_t flags) {
  if (count == 0) return;
  std::vector<uint32_t>& words = scene_.surfaces.words;
  words.resize(scene_.triangles.size(), 0u);
  for (uint64_t i = first; i < first + count; ++i) words[i] |= flags;
}

void SceneBuilder::addPolygon(std::span<const int64_t> corners, const VertexRange& vertices,
                              const Place& place) {
  if (!usable(corners, vertices, place)) {
    scene_.repaired_triangles += corners.size() < 3 ? 1 : corners.size() - 2;
    return;
  }
  const auto vertex = [&](size_t corner) { return uint32_t(vertices.first + corners[corner]); };
  if (corners.size() == 3) {
    addTriangle({vertex(0), vertex(1), vertex(2)}, place);
    return;
  }
  corners_.clear();
  cut_.clear();
  for (size_t i = 0; i < corners.size(); ++i) corners_.push_back(scene_.positions[vertex(i)]);
  cut_tests_left_ += kCutTestsACorner * corners.size();
  if (!triangulate(corners_, cut_, cut_tests_left_)) {
    throw Error(
        fmt::format("{}: concave face of {} corners is too much (at most {}, not too entangled); split it",
                    place(), corners.size(), kMaxConcaveCorners));
  }
  for (const glm::uvec3& t : cut_) addTriangle({vertex(t.x), vertex(t.y), vertex(t.z)}, place);
}

void SceneBuilder::reserve(uint64_t positions, uint64_t triangles) {
  scene_.positions.reserve(scene_.positions.size() + positions);
  scene_.triangles.reserve(scene_.triangles.size() + triangles);
}

uint32_t SceneBuilder::addMesh(Scene mesh) {
  std::vector<uint32_t>& words = mesh.surfaces.words;
  if (!words.empty()) words.resize(mesh.triangles.size(), 0u);
  meshes_.push_back({std::move(mesh.positions), std::move(mesh.triangles), std::move(words)});
  return uint32_t(meshes_.size() - 1);
}

void SceneBuilder::place(uint32_t mesh, const Placement& place) {
  closeObject();
  SceneInstance instance;
  instance.mesh = mesh;
  instance.first_id = uint32_t(triangleCount());
  instance.place = place;
  scene_.instances.push_back(instance);
}

/// Puts the meshes behind what is in none; writes them out where they do not pay.
void SceneBuilder::joinMeshes() {
  if (scene_.instances.empty()) return;
  std::vector<uint32_t>& words = scene_.surfaces.words;
  for (MeshData& mesh : meshes_) {
    if (!mesh.words.empty()) {
      words.resize(scene_.triangles.size(), 0u);
      words.insert(words.end(), mesh.words.begin(), mesh.words.end());
    }
    const auto first = uint32_t(scene_.positions.size());
    scene_.meshes.push_back({first, uint32_t(mesh.positions.size()), uint32_t(scene_.triangles.size()),
                             uint32_t(mesh.triangles.size())});
    scene_.positions.insert(scene_.positions.end(), mesh.positions.begin(), mesh.positions.end());
    for (const glm::uvec3& t : mesh.triangles) scene_.triangles.push_back(t + first);
    mesh = {};
  }
  if (!words.empty()) words.resize(scene_.triangles.size(), 0u);
  countInstances(scene_);
  if (scene_.vertexCount() > kMaxElements) throw Error("the instances have too many vertices");
  if (flatten_ || !instancesPay(scene_.triangles.size(), scene_.triangleCount())) {
    scene_ = sightline::flatten(std::move(scene_));
  }
}

Scene SceneBuilder::finish(const std::string& file) {
  closeObject();
  joinMeshes();
  if (scene_.triangles.empty()) {
    if (scene_.repaired_triangles != 0) {
      throw Error(fmt::format("{}: no triangle is left; all {} were dropped as bad", file,
                              scene_.repaired_triangles));
    }
    std::string why;
    for (const std::string& warning : scene_.warnings) why += "; " + warning;
    throw Error(fmt::format("{}: holds no triangles{}", file, why));
  }
  const Bounds bounds = sceneBounds(scene_);
  const glm::vec3 extent = bounds.high - bounds.low;
  const float longest = std::max({extent.x, extent.y, extent.z});
  if (longest > 0 && longest < kSmallestExtent) {
    throw Error(fmt::format("{}: the scene is {:g} long, too small to trace; scale it to {:g} or more", file,
                            longest, kSmallestExtent));
  }
  if (!scene_.surfaces.empty()) scene_.surfaces.words.resize(scene_.triangles.size(), 0u);
  scene_.degenerate_triangles = countDegenerate(scene_);
  if (scene_.offset == glm::dvec3(0.0) && may_need_offset_) {
    const glm::dvec3 offset = neededOffset(scene_, remainders_);
    if (offset != glm::dvec3(0.0)) throw NeedsOffset(offset);
  }
  const std::string lost = precisionWarning(scene_, remainders_, file_has_floats_);
  if (!lost.empty()) warn(lost);
  return std::move(scene_);
}

}  // namespace sightline
