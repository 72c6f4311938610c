#pragma once
#include <cstdint>
#include <optional>
#include <string>

namespace sightline {

/// In which order gvs++ traces its rays. The values are those of .pvs files.
enum class Order : uint32_t {
  kQueue = 0,  ///< the thesis's: border rays of a batch of triangles, then their reverse rays, until no
               ///< triangle is left; then random rays again
  kYield = 1,  ///< the kind of ray that finds the most triangles a ray; all of them before the bake stops
};

/// "queue" or "yield".
std::string orderName(Order order);

/// The order of that name, if there is one.
std::optional<Order> orderOf(const std::string& name);

}  // namespace sightline
