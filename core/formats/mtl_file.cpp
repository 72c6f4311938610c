#include "core/formats/mtl_file.h"

#include <optional>

#include "core/formats/obj_lines.h"
#include "core/io/decimal.h"

namespace sightline {
namespace {

/// What a material says of its opacity.
struct Opacity {
  std::string name;
  std::optional<double> d, tr;
  bool map = false;

  bool seeThrough() const { return map || (d ? *d < 1.0 : tr.value_or(0.0) > 0.0); }
};

/// The number after "d" or "Tr", and after an option such as "-halo".
std::optional<double> takeNumber(std::string_view rest) {
  std::string_view behind = rest;
  if (takeWord(behind).starts_with("-halo")) rest = behind;
  const std::optional<Decimal> number = takeDecimal(rest);
  return number ? std::optional(number->full) : std::nullopt;
}

}  // namespace

void listSeeThrough(std::string_view mtl, std::set<std::string, std::less<>>& names) {
  ObjLines lines(mtl);
  Opacity material;
  const auto close = [&] {
    if (material.seeThrough()) names.insert(material.name);
  };
  while (lines.next()) {
    std::string_view rest = lines.line();
    const std::string_view keyword = takeWord(rest);
    if (keyword == "newmtl") {
      close();
      material = {std::string(trimmed(rest)), {}, {}, false};
    } else if (keyword == "d") {
      material.d = takeNumber(rest);
    } else if (keyword == "Tr") {
      material.tr = takeNumber(rest);
    } else if (keyword == "map_d") {
      material.map = true;
    }
  }
  close();
}

}  // namespace sightline
