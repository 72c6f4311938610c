#pragma once
#include <exception>

namespace sightline {

/// Thrown by long work when its stop flag became true: nothing of the step at hand is kept.
struct Interrupted : std::exception {
  const char* what() const noexcept override { return "interrupted"; }
};

}  // namespace sightline
