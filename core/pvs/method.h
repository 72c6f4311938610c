#pragma once
#include <cstdint>
#include <optional>
#include <string>

namespace sightline {

/// How a view cell's set is computed. All but the last start from the same random rays. The values are those
/// of .pvs files.
enum class Method : uint32_t {
  kGvspp = 0,   ///< guided visibility sampling ++ (Koch and Wimmer 2021)
  kGvs = 1,     ///< guided visibility sampling (Wonka et al. 2006; thesis, chapter 4)
  kRandom = 2,  ///< random rays alone (RAND of the thesis)
  kRaster = 3,  ///< rasterised hemicubes (Nirenstein and Blake 2004)
  kNaive = 4,   ///< gvs++ with set and queue on the host (thesis 5.6)
  kBound = 5,   ///< no rays: all that is not proved hidden (core/bound/bound_cell.h)
};

/// "gvs++", "gvs", "random", "raster", "naive" or "bound".
std::string methodName(Method method);

/// The method of that name, if there is one.
std::optional<Method> methodOf(const std::string& name);

}  // namespace sightline
