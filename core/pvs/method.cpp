#include "core/pvs/method.h"

#include <algorithm>
#include <iterator>

namespace sightline {
namespace {

constexpr const char* kNames[] = {"gvs++", "gvs", "random", "raster", "naive"};

}  // namespace

std::string methodName(Method method) {
  return uint32_t(method) < std::size(kNames) ? kNames[uint32_t(method)] : "unknown";
}

std::optional<Method> methodOf(const std::string& name) {
  const auto found = std::find(std::begin(kNames), std::end(kNames), name);
  if (found == std::end(kNames)) return std::nullopt;
  return Method(found - std::begin(kNames));
}

}  // namespace sightline
