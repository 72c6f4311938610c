#include "core/pvs/param_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>

namespace sightline {
namespace {

/// Becomes a value of any type, to count the fields of an aggregate.
struct AnyValue {
  template <typename T>
  operator T() const;
};

template <typename Aggregate, typename... Values>
consteval size_t countFields() {
  if constexpr (requires { Aggregate{Values{}..., AnyValue{}}; }) {
    return countFields<Aggregate, Values..., AnyValue>();
  } else {
    return sizeof...(Values);
  }
}
static_assert(countFields<BakeParams>() == std::size(kParams),
              "a field of BakeParams has no line in kParams");

std::string textOf(Method method) {
  return methodName(method);
}
std::string textOf(Order order) {
  return orderName(order);
}
template <typename Number>
std::string textOf(Number number) {
  return fmt::format("{}", number);
}

template <typename Value>
std::string rangeOf(const ParamField<Value>& field) {
  if constexpr (std::is_enum_v<Value>) {
    std::string names;
    for (uint32_t i = uint32_t(field.low); i <= uint32_t(field.high); ++i) {
      names += (names.empty() ? "" : ", ") + textOf(Value(i));
    }
    return names;
  } else {
    if (std::is_floating_point_v<Value> && double(field.high) == double(param_table::kMostFloat)) {
      return "finite and not negative";
    }
    if (field.high == std::numeric_limits<Value>::max()) {
      return field.low == 0 ? "any" : fmt::format("at least {}", field.low);
    }
    return fmt::format("{} .. {}", field.low, field.high);
  }
}

}  // namespace

std::string paramGroupName(ParamGroup group) {
  constexpr const char* kNames[] = {"method",    "seed",  "samples",    "thinning", "distances",
                                    "stop rule", "batch", "validation", "holes"};
  static_assert(std::size(kNames) == std::size(kParamGroups));
  return kNames[size_t(group)];
}

std::string optionOf(const Param& param) {
  std::string option = std::string("--") + param.name;
  std::replace(option.begin(), option.end(), '_', '-');
  return option;
}

std::string rangeText(const Param& param) {
  return std::visit(
      [&](const auto& field) {
        const bool zero_beside = param.off != nullptr && field.low > decltype(field.low)(0);
        return (zero_beside ? "0 (off) or " : "") + rangeOf(field);
      },
      param.field);
}

std::string valueText(const Param& param, const BakeParams& params) {
  return std::visit([&](const auto& field) { return textOf(params.*field.member); }, param.field);
}

std::string shownText(const Param& param, const BakeParams& params) {
  const std::string value = valueText(param, params);
  return param.off != nullptr && value == "0" ? param.off : value;
}

bool sameValue(const Param& param, const BakeParams& a, const BakeParams& b) {
  return std::visit([&](const auto& field) { return a.*field.member == b.*field.member; }, param.field);
}

std::string paramProblem(const BakeParams& params) {
  for (const Param& param : kParams) {
    const bool good = std::visit(
        [&](const auto& field) {
          const auto value = params.*field.member;
          if (param.off != nullptr && value == decltype(value)(0)) return true;
          return value >= field.low && value <= field.high;  // false for NaN
        },
        param.field);
    if (!good) return fmt::format("{} must be {}", optionOf(param).substr(2), rangeText(param));
  }
  return {};
}

}  // namespace sightline
