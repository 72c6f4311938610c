// Runs one kernel with a fault, named by the argument, or "clean", one without: what Oclgrind must find, and
// what it must not (faults_test.sh).
#include <fmt/format.h>

#include <exception>

#include "core/opencl/opencl_context.h"

namespace sightline {
namespace {

constexpr size_t kItems = 64;

constexpr const char* kSource = R"(
__kernel void clean(volatile __global uint* slots) {
  if (atomic_or(&slots[0], 0u) > get_global_id(0)) atomic_min(&slots[0], (uint)get_global_id(0));
}
__kernel void race(volatile __global uint* slots) {
  if (slots[0] > get_global_id(0)) atomic_min(&slots[0], (uint)get_global_id(0));
}
__kernel void outOfBounds(volatile __global uint* slots) { slots[get_global_id(0) + 1] = 7u; }
)";

void run(const char* name) {
  OpenClContext context("opencl");
  context.build(kSource, kClBuildOptions);
  const ClBuffer slots = context.buffer(kItems * 4, "slots");
  context.fill(slots, 1000, kItems * 4);
  context.launch(context.kernel(name), kItems, 8, slots);
  context.finish();
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  try {
    sightline::run(argc > 1 ? argv[1] : "clean");
  } catch (const std::exception& error) {
    fmt::print("{}\n", error.what());
    return 1;
  }
}
