#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace sightline {

/// The ground of the canyon scene: a plateau with a meandering canyon along x and side canyons, whose walls
/// fall in steps; each step's cliff leans out over its foot.
///
///   steepness t:  0 river ... kCanyonFloor foot of the wall ... 1 rim, more than 1 plateau
///
///      ____ plateau                        ____
///          \_                            _/
///           _)__ ledge            ______(_      cliffs overhang: the sheet is no heightfield
///               \_              _/
///                )____ floor __(
class CanyonTerrain {
 public:
  CanyonTerrain(float extent, uint64_t seed);

  float extent() const { return extent_; }  ///< x and z from -extent / 2 to extent / 2
  float width() const { return width_; }    ///< from the river to the rim
  float depth() const { return depth_; }    ///< from the floor to the rim; the floor is near y = 0
  float riverZ(float x) const;
  /// How far from the nearest river, in shares of the canyon's width there.
  float steepness(glm::vec2 xz) const;
  /// Height of the ground, before cliffs lean out.
  float height(glm::vec2 xz) const;
  /// The ground's point for a place on the map; with the lean of the cliffs.
  glm::vec3 surface(glm::vec2 xz) const;

 private:
  struct Side {
    float x, direction, reach, phase;
  };
  float heightAt(float t, glm::vec2 xz) const;

  float extent_, width_, depth_;
  uint32_t steps_;
  uint64_t seed_;
  std::vector<Side> sides_;
};

inline constexpr float kCanyonFloor = 0.24f;

}  // namespace sightline
