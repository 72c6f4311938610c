#pragma once
#include <set>
#include <string>
#include <string_view>

namespace sightline {

/// Adds to `names` the materials of a .mtl file that one sees through: d below 1, or Tr above 0 where no d is
/// given (exporters disagree on which way Tr counts), or a map_d. What it cannot read it passes over.
void listSeeThrough(std::string_view mtl, std::set<std::string, std::less<>>& names);

}  // namespace sightline
