#include "core/pvs/method.h"

#include <algorithm>
#include <iterator>

namespace sightline {
namespace {

constexpr const char* kMethodNames[] = {"gvs++", "gvs", "random", "raster", "naive", "bound"};

}  // namespace

std::string methodName(Method method) {
  return uint32_t(method) < std::size(kMethodNames) ? kMethodNames[uint32_t(method)] : "unknown";
}

std::optional<Method> methodOf(const std::string& name) {
  const auto found = std::find(std::begin(kMethodNames), std::end(kMethodNames), name);
  if (found == std::end(kMethodNames)) return std::nullopt;
  return Method(found - std::begin(kMethodNames));
}

}  // namespace sightline
