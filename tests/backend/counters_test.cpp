// What devices count, stage by stage: rays steer batches and limits, so all must count alike. A ray without
// direction is none.
#include <gtest/gtest.h>

#include "core/device/naive/naive_device.h"
#include "core/device/registry/make_device.h"
#include "core/generate/generate.h"
#include "core/sampling/face_rays.h"
#include "core/sampling/make_stage_params.h"
#include "core/sampling/random_segment.h"
#include "tests/support/bake_scene.h"
#include "tests/support/boxes.h"
#include "tests/support/vulkan.h"

namespace sightline {
namespace {

/// A device, and whose hits it finds.
struct Configuration {
  std::string name, device;
  DeviceOptions options;
  friend std::ostream& operator<<(std::ostream& out, const Configuration& c) { return out << c.name; }
};

std::vector<Configuration> configurations() {
  std::vector<Configuration> all{{"Cpu", "cpu", {}}, {"OpenCl", "opencl", {}}, {"Vulkan", "vulkan", {}}};
  for (size_t i = 0; i < 2; ++i) {
    all.push_back({all[i].name + "Hash", all[i].device, {}});
    all.back().options.set = SetKind::kHash;
  }
  for (const uint32_t rays : {1u, 8u}) {
    all.push_back({"OpenCl" + std::to_string(rays), "opencl", {}});
    all.back().options.rays_per_item = rays;
  }
  return all;
}

class Counters : public testing::TestWithParam<Configuration> {
 protected:
  void SetUp() override {
    if (GetParam().device == "vulkan") {
      SL_SKIP_WITHOUT_VULKAN();
    }
  }

  /// Calls every stage by hand and notes what it counted.
  static std::vector<std::string> run(Device& device, const std::vector<Face>& faces,
                                      const StageParams& params, std::span<const uint32_t> contained) {
    std::vector<std::string> log;
    const auto note = [&](const std::string& what) {
      log.push_back(what + ": " + std::to_string(device.counters().rays) + " rays");
    };
    uint32_t size = 0;
    const auto collect = [&](uint32_t stage) {
      const uint32_t found = device.collect(stage);
      size += found;
      note(std::to_string(found) + " found");
    };
    device.beginCell(faces, params);
    note("begin");
    device.insertContained(contained);
    size += static_cast<uint32_t>(contained.size());
    note("contained");
    uint64_t first = 0;
    for (uint32_t f = 0; f < faces.size(); ++f) {
      device.traceRandom(makeRandomSegment(f, first, 5003, static_cast<uint32_t>(first + 1)));
      first += 5003;
      note("random of a face");
    }
    collect(kStageRandom);
    uint32_t waiting = 0;
    uint32_t entry = 0;
    for (int i = 0; i < 3 && entry < size; ++i) {
      const BorderBatch batch = device.traceBorder(entry, 20'000, true);
      entry += batch.entries;
      waiting += batch.discontinuities;
      note(std::to_string(batch.entries) + " entries, " + std::to_string(batch.discontinuities) +
           " discontinuities");
      collect(kStageBorder);
    }
    for (uint32_t i = 0; i < 2; ++i) {
      device.traceReverse(i * waiting / 2, waiting / 2);
      note("reverse");
      collect(kStageReverse);
    }
    device.dropDiscontinuities();
    const BorderBatch again = device.traceBorder(0, 10'000, false);
    note(std::to_string(again.entries) + " entries again");
    collect(kStageBorder);
    for (uint32_t f = 0; f < faces.size(); ++f) {
      const uint64_t missing = device.countMissing(makeRandomSegment(f, first, 5003, 1),
                                                   haltonShifts(1, 0, RandomUse::kValidation));
      note(std::to_string(missing) + " missing");
    }
    device.beginCell(faces, params);
    note("next cell");
    return log;
  }
};

TEST_P(Counters, AreThoseOfRaysTracedOneByOne) {
  // A city about the origin with a triangle that has a corner there: from a contained entry's origin its
  // border rays at that corner have no direction.
  Scene scene = generateScene("city", 10'000, 7);
  const glm::vec3 center(generateCells("city", 10'000, 7).front().center);
  for (glm::vec3& p : scene.positions) p -= center;
  const auto corner = static_cast<uint32_t>(scene.positions.size());
  scene.positions.insert(scene.positions.end(), {{0, 0, 0}, {1, 0, 2}, {0, 1, 2}});
  scene.triangles.push_back({corner, corner + 1, corner + 2});
  const std::vector<uint32_t> contained{17, static_cast<uint32_t>(scene.triangles.size() - 1)};
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);

  const std::string driver = GetParam().device == "vulkan" ? "vulkan" : "cpu";
  const auto device = makeDevice(GetParam().device, scene, bvh, GetParam().options);
  const auto naive = makeNaiveDevice(makeDevice(driver, scene, bvh), scene);
  for (const Method method : {Method::kGvspp, Method::kGvs}) {
    BakeParams bake;
    bake.method = method;
    bake.n_abs_edge = bake.n_rs_edge = bake.n_rs_area = 3;
    for (const double depth : {2.0, 0.0}) {
      const std::vector<Face> faces = cellFaces({"cell", {0, 0, 0}, {3, 1, depth}});
      const StageParams params = makeStageParams(bake, faces, haltonShifts(1, 0, RandomUse::kSampling));
      const std::vector<std::string> log = run(*device, faces, params, contained);
      const std::vector<std::string> expected = run(*naive, faces, params, contained);
      ASSERT_EQ(log.size(), expected.size());
      for (size_t i = 0; i < log.size(); ++i) {
        EXPECT_EQ(log[i], expected[i]) << "step " << i << ", method " << int(method) << ", depth " << depth;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Devices, Counters, testing::ValuesIn(configurations()),
                         [](const auto& configuration) { return configuration.param.name; });

}  // namespace
}  // namespace sightline
