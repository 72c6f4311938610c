#include "core/picture/cell_overlay.h"

#include <algorithm>
#include <cmath>

#include "core/picture/shading.h"

namespace sightline {
namespace {

constexpr float kFaceOpacity = 0.20f, kHiddenFaceOpacity = 0.05f;  ///< of each face; front and back add up
constexpr float kEdgeOpacity = 1.0f, kHiddenEdgeOpacity = 0.40f;
constexpr double kLineShare = 1.0 / 380;  ///< line width as a share of the picture's height
constexpr double kSmallShare = 1.0 / 24;  ///< a cell that covers less of the height gets a ring
constexpr double kArrowShare = 0.5;       ///< length of a flat cell's arrow, share of its longer side
constexpr double kDepthSlack = 0.002;     ///< edges often lie on the ground: share of the distance

struct Segment {
  glm::dvec3 from{0}, to{0};
};

std::vector<Segment> outline(const ViewCell& cell, const std::vector<Face>& faces) {
  std::vector<Segment> segments;
  for (const Face& face : faces) {
    const glm::dvec3 a = glm::vec3(face.corner), u = glm::vec3(face.edge_u), v = glm::vec3(face.edge_v);
    segments.insert(segments.end(), {{a, a + u}, {a + u, a + u + v}, {a + u + v, a + v}, {a + v, a}});
  }
  if (cell.flat()) {
    const Face& face = faces.front();
    const glm::dvec3 middle = glm::vec3(face.corner + 0.5f * (face.edge_u + face.edge_v));
    const double length = kArrowShare * std::max(cell.size.x, cell.size.y);
    const glm::dvec3 tip = middle + glm::dvec3(glm::vec3(face.normal)) * length;
    const glm::dvec3 barb = glm::dvec3(glm::vec3(face.axis_u)) * (0.12 * length);
    const glm::dvec3 neck = glm::mix(middle, tip, 0.75);
    segments.insert(segments.end(), {{middle, tip}, {neck + barb, tip}, {neck - barb, tip}});
  }
  return segments;
}

void blend(Image& image, uint32_t x, uint32_t y, glm::vec3 color, float opacity) {
  Rgb& pixel = image.at(x, y);
  pixel = encode(glm::mix(decode(pixel), color, std::clamp(opacity, 0.0f, 1.0f)));
}

/// Pixels from low to high that may lie within `reach` of [a, b], as a half-open range.
std::pair<uint32_t, uint32_t> pixelRange(double a, double b, double reach, uint32_t count) {
  const double low = std::clamp(std::floor(std::min(a, b) - reach), 0.0, double(count));
  const double high = std::clamp(std::ceil(std::max(a, b) + reach), 0.0, double(count));
  return {uint32_t(low), uint32_t(high)};
}

void drawFace(Image& image, std::span<const float> depths, const PictureCamera& camera, const Face& face) {
  const glm::dvec3 normal = glm::vec3(face.normal), corner = glm::vec3(face.corner);
  const glm::dvec3 u = glm::vec3(face.edge_u), v = glm::vec3(face.edge_v);
  for (uint32_t y = 0; y < image.height; ++y) {
    for (uint32_t x = 0; x < image.width; ++x) {
      const glm::dvec3 direction = camera.direction((x + 0.5) / image.width, (y + 0.5) / image.height);
      const double slope = glm::dot(direction, normal);
      if (slope == 0) continue;
      const double depth = glm::dot(corner - camera.position, normal) / slope;
      if (!(depth > 0)) continue;
      const glm::dvec3 place = camera.position + direction * depth - corner;
      const double s = glm::dot(place, u) / glm::dot(u, u), t = glm::dot(place, v) / glm::dot(v, v);
      if (s < 0 || s > 1 || t < 0 || t > 1) continue;
      const bool hidden = depth * (1 - kDepthSlack) > depths[size_t(y) * image.width + x];
      blend(image, x, y, kCellColor, hidden ? kHiddenFaceOpacity : kFaceOpacity);
    }
  }
}

/// Marks how strongly each pixel is covered by the segment; several segments share `cover`, so that their
/// joints are not drawn twice.
void coverSegment(std::vector<float>& cover, const Image& image, std::span<const float> depths,
                  const PictureCamera& camera, const Segment& segment, double half_width) {
  const glm::dvec3 a = camera.project(segment.from), b = camera.project(segment.to);
  if (!(a.z > 0) || !(b.z > 0)) return;
  const glm::dvec2 size(image.width, image.height), from = glm::dvec2(a) * size,
                                                    along = glm::dvec2(b) * size - from;
  const double length2 = glm::dot(along, along);
  const auto [x_begin, x_end] = pixelRange(from.x, from.x + along.x, half_width + 1, image.width);
  const auto [y_begin, y_end] = pixelRange(from.y, from.y + along.y, half_width + 1, image.height);
  for (uint32_t y = y_begin; y < y_end; ++y) {
    for (uint32_t x = x_begin; x < x_end; ++x) {
      const glm::dvec2 offset = glm::dvec2(x + 0.5, y + 0.5) - from;
      const double s = length2 > 0 ? std::clamp(glm::dot(offset, along) / length2, 0.0, 1.0) : 0.0;
      const double coverage = std::clamp(half_width + 0.5 - glm::length(offset - along * s), 0.0, 1.0);
      if (coverage == 0) continue;
      const double depth = 1 / glm::mix(1 / a.z, 1 / b.z, s);
      const size_t pixel = size_t(y) * image.width + x;
      const bool hidden = depth * (1 - kDepthSlack) > depths[pixel];
      cover[pixel] = std::max(cover[pixel], float(coverage) * (hidden ? kHiddenEdgeOpacity : kEdgeOpacity));
    }
  }
}

/// A ring where the whole outline covers less than a small share of the picture.
void ringSmallCell(Image& image, const PictureCamera& camera, const std::vector<Segment>& segments,
                   double line_width) {
  glm::dvec2 low(1e30), high(-1e30);
  for (const Segment& segment : segments) {
    for (const glm::dvec3& end : {camera.project(segment.from), camera.project(segment.to)}) {
      if (!(end.z > 0)) return;
      const glm::dvec2 place = glm::dvec2(end) * glm::dvec2(image.width, image.height);
      low = glm::min(low, place);
      high = glm::max(high, place);
    }
  }
  const double small = kSmallShare * image.height;
  if (glm::length(high - low) >= small) return;
  const glm::dvec2 middle = (low + high) * 0.5;
  drawRing(image, middle.x, middle.y, small * 0.8, line_width, encode(kCellColor));
}

}  // namespace

void drawRing(Image& image, double x, double y, double radius, double line_width, Rgb color) {
  const double reach = radius + line_width + 1;
  const auto [x_begin, x_end] = pixelRange(x, x, reach, image.width);
  const auto [y_begin, y_end] = pixelRange(y, y, reach, image.height);
  for (uint32_t row = y_begin; row < y_end; ++row) {
    for (uint32_t column = x_begin; column < x_end; ++column) {
      const double distance = std::hypot(column + 0.5 - x, row + 0.5 - y);
      const double coverage = line_width / 2 + 0.5 - std::abs(distance - radius);
      blend(image, column, row, decode(color), float(coverage));
    }
  }
}

void drawCell(Image& image, std::span<const float> depths, const PictureCamera& camera, const ViewCell& cell) {
  const std::vector<Face> faces = cellFaces(cell);
  const std::vector<Segment> segments = outline(cell, faces);
  const double line_width = std::max(1.2, kLineShare * image.height);
  for (const Face& face : faces) drawFace(image, depths, camera, face);
  std::vector<float> cover(image.pixels.size(), 0.0f);
  for (const Segment& segment : segments) coverSegment(cover, image, depths, camera, segment, line_width / 2);
  for (uint32_t y = 0; y < image.height; ++y) {
    for (uint32_t x = 0; x < image.width; ++x) {
      const float opacity = cover[size_t(y) * image.width + x];
      if (opacity > 0) blend(image, x, y, kCellColor, opacity);
    }
  }
  ringSmallCell(image, camera, segments, line_width);
}

}  // namespace sightline
