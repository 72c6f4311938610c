// What copies, memory types and waiting cost on a Vulkan device, for the choices of docs/vulkan.md.
//
//   bench_vulkan [--device NAME] [--runs N]
//
// Medians of the runs, after one that warms up.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "core/cli/number_checks.h"
#include "core/device/vulkan/tracing_needs.h"
#include "core/vulkan/vulkan_commands.h"
#include "tests/bench/bench_main.h"

namespace sightline {
namespace {

constexpr uint64_t kBytes = 256u << 20;
constexpr uint64_t kPiece = 16u << 20;

double medianSeconds(int runs, const std::function<void()>& work) {
  work();
  std::vector<double> seconds;
  for (int i = 0; i < runs; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds[seconds.size() / 2];
}

void printRate(const char* what, double seconds) {
  fmt::print("{:<58} {:7.2f} GB/s\n", what, double(kBytes) / seconds * 1e-9);
}

/// Uploads by one staging buffer: fill, copy, wait.
void uploadByOne(VulkanCommands& commands, const VulkanBuffer& staging, const VulkanBuffer& target,
                 const std::vector<char>& data) {
  for (uint64_t first = 0; first < kBytes; first += kPiece) {
    std::memcpy(staging.mapped(), data.data() + first, kPiece);
    commands.copy(staging, target, kPiece, 0, first);
    commands.finish();
  }
}

void benchUploads(const VulkanContext& context, int runs) {
  const std::vector<char> data(kBytes, 1);
  const VulkanBuffer target = context.buffer(kBytes, "target");
  const VulkanBuffer staging = context.buffer(kPiece, "staging memory", VulkanMemory::kUpload);
  VulkanCommands main(context, context.queue(), context.queueFamily());
  VulkanCommands copies(context, context.transferQueue(), context.transferFamily());
  fmt::print("a queue for copies alone: {}\n", context.queue() != context.transferQueue() ? "yes" : "no");
  printRate("upload, one staging buffer, main queue",
            medianSeconds(runs, [&] { uploadByOne(main, staging, target, data); }));
  printRate("upload, one staging buffer, queue for copies",
            medianSeconds(runs, [&] { uploadByOne(copies, staging, target, data); }));
  VulkanUpload upload(context);
  printRate("upload, two staging buffers, queue for copies (ours)", medianSeconds(runs, [&] {
              upload.write(target, data.data(), kBytes);
              upload.finish();
            }));
}

void benchReadback(const VulkanContext& context, int runs) {
  std::vector<char> data(kBytes);
  const VulkanBuffer source = context.buffer(kBytes, "source");
  VulkanCommands commands(context, context.queue(), context.queueFamily());
  for (const auto& [what, memory] : {std::pair("readback, write-combined memory", VulkanMemory::kUpload),
                                     {"readback, cached memory (ours)", VulkanMemory::kReadback}}) {
    const VulkanBuffer staging = context.buffer(kBytes, "staging memory", memory);
    printRate(what, medianSeconds(runs, [&] {
                commands.copy(source, staging, kBytes);
                commands.finish();
                std::memcpy(data.data(), staging.mapped(), kBytes);
              }));
  }
}

void benchWaiting(const VulkanContext& context, int runs) {
  constexpr int kFills = 1000;
  const VulkanBuffer buffer = context.buffer(4096, "target");
  VulkanCommands commands(context, context.queue(), context.queueFamily());
  const double apart = medianSeconds(runs, [&] {
    for (int i = 0; i < kFills; ++i) {
      commands.fill(buffer, uint32_t(i), 4096);
      commands.finish();
    }
  });
  const double together = medianSeconds(runs, [&] {
    for (int i = 0; i < kFills; ++i) commands.fill(buffer, uint32_t(i), 4096);
    commands.finish();
  });
  fmt::print("{:<58} {:7.2f} us\n", "a small command, submitted and waited for", apart / kFills * 1e6);
  fmt::print("{:<58} {:7.2f} us\n", "a small command after a full barrier, one wait for all",
             together / kFills * 1e6);
  const double allocations = medianSeconds(runs, [&] {
    for (int i = 0; i < 16; ++i) context.buffer(kPiece, "staging memory", VulkanMemory::kReadback);
  });
  fmt::print("{:<58} {:7.2f} us\n", "a buffer of 16 MiB for reading back, made and freed",
             allocations / 16 * 1e6);
}

void bench(const std::string& device, int runs) {
  const VulkanContext context(device, tracingNeeds(false));
  fmt::print("{} ({}; {})\n", context.info().id, context.info().name, context.info().driver);
  benchUploads(context, runs);
  benchReadback(context, runs);
  benchWaiting(context, runs);
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  std::string device = "vulkan";
  int runs = 9;
  CLI::App app("What copies, memory types and waiting cost on a Vulkan device", "bench_vulkan");
  app.add_option("--device", device)->capture_default_str();
  app.add_option("--runs", runs)->check(sightline::between(1, 1e6))->capture_default_str();
  return sightline::benchMain(app, argc, argv, [&] { sightline::bench(device, runs); });
}
