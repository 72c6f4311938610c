// Runs every OpenCL kernel on a scene of about 1,000 triangles, to be run under Oclgrind (kernels_test.sh):
// every method and set, both layouts, and compares what comes out with the device cpu. With the argument
// "scenes": on scenes with surfaces and with instances, for which kernels are compiled apart. With "voxels":
// the voxeliser. Exit 1 where it differs.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdio>
#include <exception>
#include <sstream>
#include <string>
#include <vector>

#include "cl_kernels/program_source.h"
#include "core/device/gpu/gpu_set.h"
#include "core/device/opencl/opencl_stages.h"
#include "core/device/registry/make_device.h"
#include "core/generate/generate.h"
#include "core/gvs/bake_cell.h"
#include "core/sampling/make_stage_params.h"
#include "core/sampling/random_segment.h"
#include "core/scene/masked_triangle.h"
#include "core/scene/scene_tree.h"
#include "core/shared/random_ray.h"
#include "core/shared/set.h"
#include "core/trace/cpu_tracer.h"
#include "core/voxel/opencl/voxelize_opencl.h"
#include "tests/support/instanced_scene.h"
#include "tests/support/random_triangles.h"

namespace sightline {
namespace {

bool same = true;

void expect(bool holds, const std::string& what) {
  if (!holds) fmt::print("differs from cpu: {}\n", what);
  same = same && holds;
  std::fflush(stdout);
}

BakeParams paramsOf(Method method) {
  BakeParams params;
  params.method = method;
  params.n_rand = 300;
  params.validation_rays = 200;
  params.max_rays = 3000;
  params.n_abs_edge = 1;
  return params;
}

void bake(const Scene& scene, const Bvh& bvh, const ViewCell& cell, uint32_t rays_per_item, Method method,
          SetKind set) {
  DeviceOptions options;
  options.rays_per_item = rays_per_item;
  options.set = set;
  const BakeParams params = paramsOf(method);
  const CellPvs wanted = bakeCell(*makeDevice("cpu", scene, bvh, options), scene, cell, 0, params);
  const CellPvs found = bakeCell(*makeDevice("opencl", scene, bvh, options), scene, cell, 0, params);
  const std::string what = fmt::format("{}, {} set, {} rays an item", methodName(method),
                                       set == SetKind::kHash ? "hash" : "array", rays_per_item);
  fmt::print("{}: {} triangles; {} random, {} border, {} reverse rays\n", what, found.triangles.size(),
             found.stats.random.rays, found.stats.border.rays, found.stats.reverse.rays);
  expect(found.triangles == wanted.triangles, what);
  expect(found.stats.random.rays == wanted.stats.random.rays, what + ", random rays");
  expect(found.stats.border.rays == wanted.stats.border.rays, what + ", border rays");
  expect(found.stats.reverse.rays == wanted.stats.reverse.rays, what + ", reverse rays");
  expect(found.witnesses.size() == wanted.witnesses.size() &&
             std::equal(found.witnesses.begin(), found.witnesses.end(), wanted.witnesses.begin(),
                        [](const Witness& a, const Witness& b) {
                          return a.origin == b.origin && a.direction == b.direction && a.stage == b.stage;
                        }),
         what + ", witnesses");
}

bool sameHits(const std::vector<Hit>& a, const std::vector<Hit>& b) {
  return std::ranges::equal(a, b, [](const Hit& x, const Hit& y) {
    return std::bit_cast<uint32_t>(x.t) == std::bit_cast<uint32_t>(y.t) && x.triangle == y.triangle;
  });
}

/// Rays and views from the middle of the cell.
void traceRaysAndViews(const Scene& scene, const Bvh& bvh, vec3 eye, uint32_t rays_per_item) {
  DeviceOptions options;
  options.rays_per_item = rays_per_item;
  const auto device = makeDevice("opencl", scene, bvh, options);
  const CpuTracer reference(scene, bvh);
  testing_support::Random random(1);
  std::vector<Ray> rays(203);  // the last work item has lanes to spare
  for (Ray& ray : rays) ray = {vec4(eye, 0), vec4(random.point(1), 0)};
  std::vector<Hit> hits(rays.size()), wanted;
  for (const Ray& ray : rays) wanted.push_back(reference.trace(ray));
  device->traceRays(rays, hits);
  expect(sameHits(hits, wanted), fmt::format("hits of rays, {} an item", rays_per_item));

  constexpr uint32_t kResolution = 9;
  const std::vector<ViewFrame> frames = {
      {vec4(eye, 0), vec4(0, 0, 1, 0), vec4(1, 0, 0, 0), vec4(0, 1, 0, 0)},
      {vec4(eye, 0), vec4(1, 0, 0, 0), vec4(0, 0, -1, 0), vec4(0, 1, 0, 0)}};
  std::vector<uint32_t> image(frames.size() * kResolution * kResolution), wanted_image;
  for (const ViewFrame& frame : frames) {
    for (uint32_t i = 0; i < kResolution * kResolution; ++i) {
      wanted_image.push_back(
          reference.trace(viewRay(frame, i % kResolution, i / kResolution, kResolution)).triangle);
    }
  }
  device->traceViews(frames, kResolution, image);
  expect(image == wanted_image, fmt::format("views, {} rays an item", rays_per_item));
}

/// Triangles put into the set without rays, as those that a cell contains.
void insertContained(const Scene& scene, const Bvh& bvh, const ViewCell& cell, SetKind set) {
  DeviceOptions options;
  options.set = set;
  const std::vector<Face> faces = cellFaces(cell);
  const StageParams params = makeStageParams(paramsOf(Method::kGvspp), faces, uvec4(1, 2, 3, 4));
  const std::vector<uint32_t> triangles = {3, 5, 8, 300};
  const auto device = makeDevice("opencl", scene, bvh, options);
  device->beginCell(faces, params);
  device->insertContained(triangles);
  std::vector<uint32_t> found;
  for (const PvsEntry& entry : device->readPvs()) found.push_back(entry.origin_triangle.w);
  expect(found == triangles, "contained triangles");
}

/// traceSegmentKernel, which benchmarks run.
void traceSegment(const Scene& scene, const Bvh& bvh, vec3 eye, uint32_t rays_per_item) {
  OpenClContext context("opencl");
  buildKernels(context, rays_per_item);
  const OpenClScene uploaded = uploadScene(context, scene, bvh, rays_per_item);
  Face face{};
  face.corner = vec4(eye, 0);
  face.edge_u = face.axis_u = vec4(1, 0, 0, 0);
  face.edge_v = face.axis_v = vec4(0, 1, 0, 0);
  face.normal = vec4(0, 0, 1, 0);
  const uvec4 shifts(123456789u, 12345678u, 99u, 1000007u);
  const RandomSegment segment = makeRandomSegment(0, 5000, 301, 1);
  const uint64_t slots = slotCount(segment);
  const ClBuffer buffer = context.buffer(slots * sizeof(Hit), "hits");
  context.launch(context.kernel("traceSegmentKernel"), (slots + rays_per_item - 1) / rays_per_item, 8,
                 uploaded.nodes, uploaded.triangles, uploaded.reach, segment, face, shifts, buffer);
  std::vector<Hit> hits(slots), wanted;
  context.read(buffer, hits.data(), slots * sizeof(Hit));
  const CpuTracer reference(scene, bvh);
  for (uint32_t slot = 0; slot < slots; ++slot) {
    wanted.push_back(reference.trace(offsetRay(segment, face, shifts, slotOffset(segment, slot))));
  }
  expect(sameHits(hits, wanted), fmt::format("hits of a segment, {} rays an item", rays_per_item));
}

/// A scene of 1,000 triangles fills no hash set, so this fills one by hand and lets it grow.
void growHashSet(const Scene& scene, const Bvh& bvh) {
  constexpr uint32_t kTriangles = 3000;
  OpenClStages api("opencl", scene, bvh, {});
  GpuSet<OpenClStages> set(api, kTriangles, true);
  std::vector<uint32_t> keys(set.capacity(), kNoTriangle), winner(set.capacity(), kSlotEmpty), unused(1000);
  for (uint32_t i = 0; i < kTriangles; ++i) {
    const uint32_t slot =
        claimSlot({keys.data(), winner.data(), unused.data(), unused.data(), set.capacity()}, i);
    winner[slot] = i + 1;
  }
  api.write(set.keys(), keys.data(), keys.size() * 4);
  api.write(set.winner(), winner.data(), winner.size() * 4);
  set.grow(2);
  keys.resize(set.capacity());
  winner.resize(set.capacity());
  api.read(set.keys(), keys.data(), keys.size() * 4);
  api.read(set.winner(), winner.data(), winner.size() * 4);
  bool kept = true;
  for (uint32_t i = 0; i < kTriangles; ++i) {
    const uint32_t slot =
        findSlot({keys.data(), winner.data(), unused.data(), unused.data(), set.capacity()}, i);
    kept = kept && slot != kSlotEmpty && winner[slot] == i + 1;
  }
  expect(kept, "hash set after it grew");
}

/// Prints all kernels that the program has, a line "kernel NAME" each, as the compiler knows them.
void printKernels() {
  OpenClContext context("opencl");
  buildKernels(context, 1);
  const ClKernel kernel = context.kernel("traceRandom");
  cl_program program = nullptr;
  checkCl(clGetKernelInfo(kernel.get(), CL_KERNEL_PROGRAM, sizeof program, &program, nullptr),
          "clGetKernelInfo");
  std::vector<char> names(1 << 16);
  checkCl(clGetProgramInfo(program, CL_PROGRAM_KERNEL_NAMES, names.size(), names.data(), nullptr),
          "clGetProgramInfo");
  std::string name;
  std::istringstream list(names.data());
  while (std::getline(list, name, ';')) fmt::print("kernel {}\n", name);
}

/// The scene with holes, glass and fronts alone among its stored triangles.
Scene withSurfaces(Scene scene) {
  Surfaces& surfaces = scene.surfaces;
  const uint32_t mask =
      addMask(surfaces, 7, 3, {kWrapRepeat, kWrapMirror}, [](uint64_t texel) { return texel % 3 != 0; });
  for (size_t id = 0; id < scene.triangles.size(); ++id) {
    constexpr uint32_t kWords[] = {0, kSurfaceGlass, kSurfaceFrontOnly, kSurfaceMasked};
    uint32_t word = kWords[id % 4];
    if (word == kSurfaceMasked) {
      word |= uint32_t(surfaces.masked.size());
      surfaces.masked.push_back(
          *maskedTriangle(surfaces, mask, {glm::dvec2(0, 0), glm::dvec2(90, 1), glm::dvec2(2, 80)}));
    }
    surfaces.words.push_back(word);
  }
  return scene;
}

/// Kernels that are compiled for what a scene needs: surfaces, and two levels of trees.
void bakeOtherScenes(const Scene& scene, const Bvh& bvh, const ViewCell& cell) {
  const Scene surfaces = withSurfaces(scene);
  const Scene instances = testing_support::randomInstances(3, 20, 40);
  const Scene instances_with_surfaces = withSurfaces(instances);
  const Bvh two_levels = buildSceneTree(instances);
  ViewCell middle = cell;
  middle.center = glm::dvec3(0);
  for (const uint32_t rays_per_item : {1u, 8u}) {
    for (const Method method : {Method::kGvspp, Method::kGvs}) {
      bake(surfaces, bvh, cell, rays_per_item, method, SetKind::kArray);
      bake(instances, two_levels, middle, rays_per_item, method, SetKind::kHash);
    }
    bake(instances_with_surfaces, two_levels, middle, rays_per_item, Method::kGvspp, SetKind::kArray);
  }
}

/// Triangles of all sizes and in all directions, some with corners on the lattice, in two blocks.
void voxelizeAll() {
  testing_support::Random random(7);
  Scene scene;
  for (uint32_t i = 0; i < 40; ++i) {
    const glm::vec3 middle = random.point(18) + glm::vec3(0, 32, 32);
    for (int corner = 0; corner < 3; ++corner) {
      const glm::vec3 place = middle + random.point(i % 8 == 0 ? 12 : 3);
      scene.positions.push_back(i % 2 == 0 ? place : glm::round(place));
    }
    scene.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  scene.objects.push_back({"all", 0, 40});
  const std::pair<Separation, bool> kinds[] = {{Separation::kConservative, false},
                                               {Separation::kConservative, true},
                                               {Separation::k26, false},
                                               {Separation::k6, true}};
  for (const auto& [separation, floats] : kinds) {
    const VoxelizeOptions options{.lattice = latticeOf(1), .separation = separation};
    const std::vector<VoxelBlock> wanted = voxelize(scene, options).blocks;
    std::vector<VoxelBlock> found;
    uint64_t voxels = 0;
    const OpenClVoxelized done = voxelizeOpenCl(scene, options, "opencl",
                                                [&](VoxelBlock&& block) {
                                                  voxels += block.count();
                                                  found.push_back(std::move(block));
                                                },
                                                {.group = 16, .floats = floats, .bricks = 8, .open_rows = 2});
    const std::string what = fmt::format("separation {}, {}", int(separation), floats ? "float" : "double");
    fmt::print("voxels: {}: {} in {} blocks, {} rows open, {} launches again\n", what, voxels, found.size(),
               done.open_rows, done.repeats);
    expect(found == wanted, what);
    expect(voxels > 500 && done.repeats > 0, what + ": too little to check");
  }
  fmt::print("kernel voxelizeBlocks\nkernel binIntoBlocks\n");
}

void runAll(const std::string& what) {
  if (what == "voxels") return voxelizeAll();
  const Scene scene = generateScene("city", 1000, 1);
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  // Large enough to hold a few triangles.
  ViewCell cell = generateCells("city", 1000, 1)[3];
  cell.size += glm::dvec3(10, 5, 10);
  if (what == "scenes") return bakeOtherScenes(scene, bvh, cell);
  printKernels();
  const vec3 eye(cell.center);
  for (const uint32_t rays_per_item : {1u, 8u}) {
    traceRaysAndViews(scene, bvh, eye, rays_per_item);
    traceSegment(scene, bvh, eye, rays_per_item);
    for (const Method method : {Method::kGvspp, Method::kGvs}) {
      for (const SetKind set : {SetKind::kArray, SetKind::kHash}) {
        bake(scene, bvh, cell, rays_per_item, method, set);
      }
    }
  }
  for (const SetKind set : {SetKind::kArray, SetKind::kHash}) insertContained(scene, bvh, cell, set);
  growHashSet(scene, bvh);
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  try {
    sightline::runAll(argc > 1 ? argv[1] : "");
  } catch (const std::exception& error) {
    fmt::print("{}\n", error.what());
    return 1;
  }
  return sightline::same ? 0 : 1;
}
