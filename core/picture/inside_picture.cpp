#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/picture/mark_pixels.h"
#include "core/picture/picture.h"
#include "core/picture/shading.h"

namespace sightline {
namespace {

constexpr Rgb kGapColor{255, 255, 255};
constexpr uint32_t kGap = 4;  ///< pixels between the panoramas

/// Where a panorama looks: longitude around up, latitude towards it.
struct Panorama {
  glm::dvec3 origin{0};
  glm::dvec3 forward{0, 0, 1}, right{1, 0, 0}, up{0, 1, 0};
  double half_longitude = std::numbers::pi, half_latitude = std::numbers::pi / 2;

  glm::dvec3 direction(double x, double y) const {
    const double longitude = (2 * x - 1) * half_longitude, latitude = (1 - 2 * y) * half_latitude;
    return std::cos(latitude) * (std::cos(longitude) * forward + std::sin(longitude) * right) +
           std::sin(latitude) * up;
  }
};

/// The longest edge of the cell, as a vector.
glm::dvec3 longestEdge(const std::vector<Face>& faces) {
  glm::dvec3 longest(0);
  for (const Face& face : faces) {
    for (const glm::vec4& edge : {face.edge_u, face.edge_v}) {
      const glm::dvec3 candidate = glm::vec3(edge);
      if (glm::dot(candidate, candidate) > glm::dot(longest, longest)) longest = candidate;
    }
  }
  return longest;
}

/// The horizontal part of a vector; a fixed direction for a vertical one.
glm::dvec3 levelled(const glm::dvec3& vector) {
  const glm::dvec3 level(vector.x, 0, vector.z);
  const double length = glm::length(level);
  return length > 1e-3 * glm::length(vector) ? level / length : glm::dvec3(0, 0, 1);
}

/// From the cell's centre and from both ends of its longest edge.
std::array<Panorama, 3> placePanoramas(const ViewCell& cell) {
  const std::vector<Face> faces = cellFaces(cell);
  const glm::dvec3 edge = longestEdge(faces);
  Panorama panorama;
  panorama.forward = levelled(edge);
  if (cell.flat()) {
    panorama.forward = glm::normalize(glm::dvec3(glm::vec3(faces.front().normal)));
    panorama.half_longitude = std::numbers::pi / 2;
    panorama.half_latitude = std::numbers::pi / 4;
  }
  const bool vertical = std::abs(panorama.forward.y) > 0.99;
  panorama.right =
      glm::normalize(glm::cross(panorama.forward, vertical ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0)));
  panorama.up = glm::cross(panorama.right, panorama.forward);
  std::array<Panorama, 3> result{panorama, panorama, panorama};
  for (size_t i = 0; i < result.size(); ++i) {
    const double place = i == 0 ? 0 : i == 1 ? -0.5 : 0.5;
    result[i].origin = cell.center + edge * place;
  }
  return result;
}

/// One large tile above two small ones.
std::array<Tile, 3> placeTiles(uint32_t width, uint32_t height) {
  const uint32_t large = height * 2 / 3, half = width / 2;
  return {Tile{0, 0, width, large}, Tile{0, large + kGap, half - kGap / 2, height - large - kGap},
          Tile{half + kGap / 2, large + kGap, width - half - kGap / 2, height - large - kGap}};
}

class InsideView {
 public:
  InsideView(const TraceRays& trace, const TraceGlass& glass, const Scene& scene, const CellPvs& pvs,
             const PictureOptions& options)
      : trace_(trace), glass_(glass), scene_(scene), member_(membership(scene, pvs.triangles)) {
    picture_.image = Image(options.width, options.height, kGapColor);
  }

  void render(const Tile& tile, const Panorama& panorama) {
    const glm::vec3 to_sun = glm::normalize(glm::vec3(0.5f, 0.8f, 0.35f));
    const auto sample_ray = [&](uint32_t x, uint32_t y) {
      return makeRay(panorama.origin, panorama.direction((x + 0.5) / (tile.width * kSamplesPerAxis),
                                                         (y + 0.5) / (tile.height * kSamplesPerAxis)));
    };
    const auto shade = [&](uint32_t x, uint32_t y, std::span<const Sample> samples) {
      glm::vec3 sum(0);
      bool shows_scene = false;
      const size_t missing_before = picture_.missing_triangles.size();
      const auto see = [&](uint32_t triangle) {
        shows_scene = true;
        if (member_[triangle] == 0) picture_.missing_triangles.push_back(triangle);
      };
      for (const auto& [ray, hit, shadow_hit, panes] : samples) {
        const glm::vec3 direction(ray.direction);
        glm::vec3 color = skyColor(std::max(0.0f, direction.y));
        for (const SeenThrough& pane : panes) see(pane.triangle);
        if (hit.triangle != kNoTriangle) {
          see(hit.triangle);
          const glm::vec3 normal = facingNormal(scene_, hit.triangle, direction);
          color = kVisibleColor * lightOn(normal, direction, to_sun, 1);
        }
        sum += throughGlass(scene_, color, panes, direction, to_sun,
                            [](uint32_t) { return kVisibleGlassColor; });
      }
      picture_.scene_pixels += shows_scene ? 1 : 0;
      if (picture_.missing_triangles.size() > missing_before) {
        missing_.push_back(size_t(y) * picture_.image.width + x);
      }
      picture_.image.at(x, y) = encode(sum / float(samples.size()));
    };
    renderTile(trace_, glass_, tile, sample_ray, {}, shade);
  }

  Picture finish() {
    picture_.missing_pixels = missing_.size();
    auto& triangles = picture_.missing_triangles;
    std::sort(triangles.begin(), triangles.end());
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
    markMissing(picture_.image, missing_);
    return std::move(picture_);
  }

 private:
  const TraceRays& trace_;
  const TraceGlass& glass_;
  const Scene& scene_;
  std::vector<uint8_t> member_;
  Picture picture_;
  std::vector<size_t> missing_;  ///< pixels
};

}  // namespace

Picture renderInside(const TraceRays& trace, const Scene& scene, const CellPvs& pvs,
                     const PictureOptions& options, const TraceGlass& glass) {
  checkSize(options.width, options.height);
  InsideView view(trace, glass, scene, pvs, options);
  const std::array<Panorama, 3> panoramas = placePanoramas(pvs.cell);
  const std::array<Tile, 3> tiles = placeTiles(options.width, options.height);
  for (size_t i = 0; i < tiles.size(); ++i) view.render(tiles[i], panoramas[i]);
  return view.finish();
}

}  // namespace sightline
