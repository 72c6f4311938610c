// Sets against their definition, in both directions, for all kinds of cells; and faults that this must find.
#include "tests/definition/definition.h"

#include <gtest/gtest.h>

#include "core/device/naive/naive_device.h"
#include "core/device/registry/make_device.h"
#include "core/gvs/bake_cell.h"
#include "tests/support/bake_scene.h"
#include "tests/support/boxes.h"
#include "tests/support/forwarding_device.h"
#include "tests/support/vulkan.h"

namespace sightline {
namespace {

using definition_test::Definition;
using testing_support::ForwardingDevice;
using testing_support::Random;

constexpr uint32_t kTries = 2000;
constexpr uint64_t kRandomRays = 60'000;

struct CellKind {
  const char* name;
  glm::dvec3 zero;  ///< factors of the size
  bool turned;
};

constexpr CellKind kKinds[] = {{"Box", {1, 1, 1}, false},    {"TurnedBox", {1, 1, 1}, true},
                               {"Flat", {1, 1, 0}, false},   {"TurnedFlat", {1, 1, 0}, true},
                               {"SheetX", {0, 1, 1}, false}, {"TurnedSheetX", {0, 1, 1}, true},
                               {"SheetY", {1, 0, 1}, false}, {"TurnedSheetY", {1, 0, 1}, true}};

ViewCell cellOf(const CellKind& kind, Random& random) {
  ViewCell cell;
  cell.name = kind.name;
  cell.center = glm::dvec3(random.point(1));
  for (int axis = 0; axis < 3; ++axis) cell.size[axis] = kind.zero[axis] * (0.3 + random.unit());
  if (kind.turned) cell.rotation = glm::dvec3(random.point(180));
  return cell;
}

/// Small triangles all about, and large ones that hide many of them and cross the cells' planes.
Scene sceneOf(Random& random) {
  Scene scene;
  for (int i = 0; i < 40; ++i) {
    const float size = i < 8 ? 3.0f : 0.7f;
    const vec3 a = random.point(4);
    testing_support::addTriangle(scene, a, a + random.point(size), a + random.point(size));
  }
  return scene;
}

BakeParams paramsOf(Method method) {
  BakeParams params;
  params.method = method;
  params.n_rand = kRandomRays;
  params.validation_rays = 0;
  params.threshold = 1;
  return params;
}

CellPvs bakeWith(Device& device, const Scene& scene, const ViewCell& cell, const BakeParams& params) {
  return bakeCell(device, scene, cell, 0, params);
}

std::unique_ptr<Device> deviceOf(const std::string& name, const Scene& scene, const Bvh& bvh) {
  return name == "naive" ? makeNaiveDevice(makeDevice("cpu", scene, bvh), scene)
                         : makeDevice(name, scene, bvh);
}

/// A line a fault of the sets of `scenes` random scenes.
std::string faultsOf(const CellKind& kind, const std::string& device, Method method, uint32_t scenes) {
  std::string lines;
  for (uint32_t seed = 1; seed <= scenes; ++seed) {
    Random random(seed);
    const Scene scene = sceneOf(random);
    const ViewCell cell = cellOf(kind, random);
    const Bvh bvh = buildBvh(scene.positions, scene.triangles);
    const CellPvs pvs = bakeWith(*deviceOf(device, scene, bvh), scene, cell, paramsOf(method));
    for (const std::string& line : Definition(scene, cell).faults(pvs, kRandomRays, kTries, random)) {
      lines += fmt::format("seed {}: {}\n", seed, line);
    }
  }
  return lines;
}

class DefinitionOf : public testing::TestWithParam<CellKind> {};

TEST_P(DefinitionOf, SetsByGvspp) {
  EXPECT_EQ(faultsOf(GetParam(), "cpu", Method::kGvspp, 16), "");
}
TEST_P(DefinitionOf, SetsByGvs) {
  EXPECT_EQ(faultsOf(GetParam(), "cpu", Method::kGvs, 16), "");
}
TEST_P(DefinitionOf, SetsByRandomRays) {
  EXPECT_EQ(faultsOf(GetParam(), "cpu", Method::kRandom, 8), "");
}
TEST_P(DefinitionOf, SetsByNaiveSampling) {
  EXPECT_EQ(faultsOf(GetParam(), "naive", Method::kNaive, 4), "");
}
TEST_P(DefinitionOf, SetsOnOpenCl) {
  EXPECT_EQ(faultsOf(GetParam(), "opencl", Method::kGvspp, 3), "");
  EXPECT_EQ(faultsOf(GetParam(), "opencl", Method::kGvs, 3), "");
}

INSTANTIATE_TEST_SUITE_P(All, DefinitionOf, testing::ValuesIn(kKinds),
                         [](const auto& kind) { return std::string(kind.param.name); });

/// A floor and a wall, both through or behind the plane of a flat cell that looks along +z.
struct HalfHidden {
  Scene scene;
  uint32_t floor = 0, wall = 0;
  ViewCell cell{"flat", {0, 0, 0}, {2, 1, 0}, {}};

  HalfHidden() {
    testing_support::SceneOfBoxes boxes;
    floor = boxes.addRectangle({-5, -1, -6}, {10, 0, 0}, {0, 0, 12});
    wall = boxes.addRectangle({-5, -1, -4}, {10, 0, 0}, {0, 6, 0});
    scene = boxes.finish();
  }
};

std::vector<uint32_t> halfHiddenSet(const std::string& device, Method method) {
  const HalfHidden s;
  return testing_support::bakeOn(device, s.scene, s.cell, paramsOf(method)).triangles;
}

TEST(FlatCell, DoesNotLookBehind) {
  const HalfHidden s;
  const auto floor = testing_support::idRange(s.floor, 2);
  for (const Method method : {Method::kGvspp, Method::kGvs, Method::kRandom}) {
    EXPECT_EQ(halfHiddenSet("cpu", method), floor);
    EXPECT_EQ(halfHiddenSet("opencl", method), floor);
  }
}

TEST(FlatCell, DoesNotLookBehindOnVulkan) {
  SL_SKIP_WITHOUT_VULKAN();
  const HalfHidden s;
  const auto floor = testing_support::idRange(s.floor, 2);
  for (const Method method : {Method::kGvspp, Method::kGvs, Method::kRandom, Method::kRaster}) {
    EXPECT_EQ(halfHiddenSet("vulkan", method), floor);
  }
}

/// Sets of flat cells in scenes of 40 triangles, on a driver's own intersector: nothing behind, no such ray.
TEST(FlatCell, HoldsNothingBehindOnVulkan) {
  SL_SKIP_WITHOUT_VULKAN();
  for (const CellKind& kind : {kKinds[2], kKinds[3]}) {
    EXPECT_EQ(faultsOf(kind, "vulkan", Method::kGvspp, 3), "");
    EXPECT_EQ(faultsOf(kind, "vulkan", Method::kGvs, 3), "");
  }
}

/// The cpu device, but for what beginCell gets and readPvs gives.
class FaultyDevice final : public ForwardingDevice {
 public:
  using CellFault = std::function<void(std::vector<Face>&, StageParams&)>;
  using SetFault = std::function<void(std::vector<PvsEntry>&)>;

  FaultyDevice(const Scene& scene, const Bvh& bvh, CellFault cell_fault, SetFault set_fault)
      : ForwardingDevice(makeDevice("cpu", scene, bvh)),
        cell_fault_(std::move(cell_fault)),
        set_fault_(std::move(set_fault)) {}

  void beginCell(std::span<const Face> faces, const StageParams& params) override {
    std::vector<Face> changed(faces.begin(), faces.end());
    StageParams changed_params = params;
    if (cell_fault_) cell_fault_(changed, changed_params);
    ForwardingDevice::beginCell(changed, changed_params);
  }
  std::vector<PvsEntry> readPvs() override {
    std::vector<PvsEntry> entries = ForwardingDevice::readPvs();
    if (set_fault_) set_fault_(entries);
    return entries;
  }

 private:
  CellFault cell_fault_;
  SetFault set_fault_;
};

/// Of `scenes` random scenes, how many sets the definition finds wrong.
uint32_t wrongSets(const CellKind& kind, const FaultyDevice::CellFault& cell_fault,
                   const FaultyDevice::SetFault& set_fault, uint32_t scenes) {
  uint32_t wrong = 0;
  for (uint32_t seed = 1; seed <= scenes; ++seed) {
    Random random(seed);
    const Scene scene = sceneOf(random);
    const ViewCell cell = cellOf(kind, random);
    const Bvh bvh = buildBvh(scene.positions, scene.triangles);
    FaultyDevice device(scene, bvh, cell_fault, set_fault);
    const CellPvs pvs = bakeWith(device, scene, cell, paramsOf(Method::kGvspp));
    wrong += Definition(scene, cell).faults(pvs, kRandomRays, kTries, random).empty() ? 0 : 1;
  }
  return wrong;
}

/// What flat cells did until they had StageParams::look.
TEST(PlantedFault, FlatCellsThatLookAllAround) {
  const auto all_around = [](std::vector<Face>&, StageParams& params) { params.look = vec4(0); };
  EXPECT_GE(wrongSets(kKinds[2], all_around, {}, 16), 4u);
  EXPECT_GE(wrongSets(kKinds[3], all_around, {}, 16), 4u);
}

TEST(PlantedFault, RaysFromBesideTheCell) {
  const auto beside = [](std::vector<Face>& faces, StageParams&) {
    for (Face& face : faces) face.corner += 0.5f * face.edge_u;
  };
  for (const CellKind& kind : kKinds) EXPECT_EQ(wrongSets(kind, beside, {}, 4), 4u) << kind.name;
}

TEST(PlantedFault, FacesThatLookInwards) {
  const auto turned = [](std::vector<Face>& faces, StageParams& params) {
    faces[0].normal = -faces[0].normal;
    if (faces.size() == 1) params.look = faces[0].normal;
  };
  EXPECT_EQ(wrongSets(kKinds[2], turned, {}, 4), 4u);  // flat: looks backwards
  EXPECT_EQ(wrongSets(kKinds[3], turned, {}, 4), 4u);
}

TEST(PlantedFault, WrongIds) {
  const auto next_id = [](std::vector<PvsEntry>& entries) {
    for (PvsEntry& entry : entries) entry.origin_triangle.w = (entry.origin_triangle.w + 1) % 40;
  };
  for (const CellKind& kind : kKinds) EXPECT_EQ(wrongSets(kind, {}, next_id, 4), 4u) << kind.name;
}

TEST(PlantedFault, LostTriangles) {
  const auto without_first = [](std::vector<PvsEntry>& entries) {
    if (!entries.empty()) entries.erase(entries.begin());
  };
  for (const CellKind& kind : kKinds) EXPECT_GE(wrongSets(kind, {}, without_first, 4), 3u) << kind.name;
}

}  // namespace
}  // namespace sightline
