// Speed of tracing on a generated city: the devices cpu, opencl and, if named, vulkan and, as the peer,
// Embree 3 (robust, single rays, all threads), in turns in one run; hits are compared in the same run.
//
//   bench_trace [--triangles N] [--rays N] [--runs N] [--device opencl[:...]] [--leaf N] [--spatial] [--json]
//               [--vulkan vulkan[:...]] [--processor-time] [--skip cpu|opencl|embree]
//
// random: rays of the first flat, volumetric and street cell, N a cell over its faces by area. Our devices
// generate the rays themselves, in strata order, and that counts; Embree gets them ready-made in Halton
// order. border: rays to the border polygons of triangles that the random rays hit, ready-made for all, same
// order.
#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <ctime>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "bvh/bvh.h"
#include "core/device/cpu_tracer.h"
#include "core/device/opencl_scene.h"
#include "core/error.h"
#include "core/gvs/random_segment.h"
#include "core/pvs/pvs.h"
#include "core/scene/generate.h"
#include "core/scene/view_cell.h"
#include "core/shared/border.h"
#include "core/shared/random_ray.h"
#include "tests/bench/vulkan_tracer.h"
#ifdef SL_HAVE_EMBREE
#include <embree3/rtcore.h>
#endif

namespace sightline {
namespace {

struct Options {
  uint64_t triangles = 2'000'000;
  uint32_t rays = 4'000'000;
  int runs = 5;
  std::string device = "opencl";
  std::string vulkan;  ///< empty: none
  BvhConfig bvh;
  std::string skip;  ///< a contestant to leave out
  bool processor_time = false;
  bool json = false;
};

/// The rays of one face of a cell: a run of the Halton sequence.
struct Run {
  Face face;
  RandomSegment segment;
  size_t first;  ///< place of its rays and hits in the arrays of all
};

struct Workload {
  Scene scene;
  Bvh bvh;
  std::vector<Run> runs;
  std::vector<Ray> random;  ///< in Halton order
  std::vector<Ray> border;
};

constexpr uvec4 kShifts(2654435769u, 40531527u, 205459861u, 31655765u);

float area(const Face& face) {
  return glm::length(vec3(face.edge_u)) * glm::length(vec3(face.edge_v));
}

void addRandomRays(Workload& work, const ViewCell& cell, uint32_t count) {
  const std::vector<Face> faces = cellFaces(cell);
  float total = 0;
  for (const Face& face : faces) total += area(face);
  uint64_t index = 0;
  for (uint32_t i = 0; i < faces.size(); ++i) {
    const uint32_t share = std::max(1u, uint32_t(double(count) * area(faces[i]) / total));
    work.runs.push_back({faces[i], makeRandomSegment(i, index, share, 1), work.random.size()});
    const size_t first = work.random.size();
    work.random.resize(first + share);
    tbb::parallel_for(0u, share,
                      [&](uint32_t k) { work.random[first + k] = randomRay(index, k, faces[i], kShifts); });
    index += share;
  }
}

/// Border rays of the triangles that a cell's rays found, in ascending id, each from the first ray's origin:
/// as the device's list has them after a batch.
void addBorderRays(Workload& work, const CpuTracer& tracer, size_t first, size_t last, size_t count) {
  const BakeParams defaults;
  StageParams params{};
  params.counts = uvec4(defaults.n_abs_edge, defaults.n_rs_edge, defaults.n_rs_area, 1);
  params.distances =
      vec4(defaults.delta_abs_relative, defaults.delta_abs, defaults.delta_rs_relative, defaults.delta_rs);
  std::map<uint32_t, vec3> found;
  for (size_t i = first; i < last && found.size() * borderRayCount(params) < count; ++i) {
    const Hit hit = tracer.trace(work.random[i]);
    if (hit.triangle != kNoTriangle) found.emplace(hit.triangle, vec3(work.random[i].origin));
  }
  for (const auto& [id, origin] : found) {
    const glm::uvec3 v = work.scene.triangles[id];
    const auto& p = work.scene.positions;
    for (uint32_t k = 0; k < borderRayCount(params); ++k) {
      work.border.push_back(borderRay(
          borderEdge(p[v.x], p[v.y], p[v.z], borderSide(k, params), origin, params), k, origin, params));
    }
  }
}

Workload makeWorkload(const Options& options) {
  Workload work;
  work.scene = generateScene("city", options.triangles, 1);
  work.bvh = buildBvh(work.scene.positions, work.scene.triangles, options.bvh);
  const CpuTracer tracer(work.scene, work.bvh);
  for (const ViewCell& cell : generateCells("city", options.triangles, 1)) {
    if (!cell.name.ends_with("-1")) continue;
    const size_t first = work.random.size();
    addRandomRays(work, cell, options.rays);
    addBorderRays(work, tracer, first, work.random.size(), options.rays / 2);
  }
  return work;
}

/// One contestant: traces all rays of a kind; hits lie in the order of Workload's rays.
struct Contestant {
  std::string name;
  std::function<void()> trace_random, trace_border;
  std::function<std::vector<Hit>()> random_hits, border_hits;
};

constexpr size_t kChunk = 1024;

Contestant cpuContestant(const Workload& work) {
  auto tracer = std::make_shared<CpuTracer>(work.scene, work.bvh);
  auto random = std::make_shared<std::vector<Hit>>(work.random.size());
  auto border = std::make_shared<std::vector<Hit>>(work.border.size());
  const auto trace_run = [&work, tracer, random](const Run& run) {
    const uint64_t slots = slotCount(run.segment);
    tbb::parallel_for(uint64_t{0}, (slots + kChunk - 1) / kChunk, [&](uint64_t chunk) {
      std::vector<Ray> rays;
      std::vector<uint32_t> offsets;
      for (uint64_t s = chunk * kChunk; s < std::min(slots, (chunk + 1) * kChunk); ++s) {
        const uint32_t offset = slotOffset(run.segment, uint32_t(s));
        if (offset == kNoTriangle) continue;
        offsets.push_back(offset);
        rays.push_back(randomRay(segmentFirst(run.segment), offset, run.face, kShifts));
      }
      std::vector<Hit> hits(rays.size());
      tracer->tracePacket(rays.data(), hits.data(), int(rays.size()));
      for (size_t i = 0; i < hits.size(); ++i) (*random)[run.first + offsets[i]] = hits[i];
    });
  };
  return {"cpu",
          [&work, trace_run] {
            for (const Run& run : work.runs) trace_run(run);
          },
          [&work, tracer, border] {
            tbb::parallel_for(size_t{0}, (work.border.size() + kChunk - 1) / kChunk, [&](size_t chunk) {
              const size_t first = chunk * kChunk, count = std::min(kChunk, work.border.size() - first);
              tracer->tracePacket(&work.border[first], &(*border)[first], int(count));
            });
          },
          [random] { return *random; }, [border] { return *border; }};
}

/// Everything that the OpenCL contestant keeps on the device.
struct OpenClState {
  explicit OpenClState(const Workload& work, const std::string& device) : context(device) {
    context.build(traceOptions(context));
    scene = uploadScene(context, work.scene, work.bvh);
    segment_kernel = context.kernel("traceSegmentKernel");
    rays_kernel = context.kernel("traceRaysKernel");
    for (const Run& run : work.runs) {
      random_hits.push_back(context.buffer(slotCount(run.segment) * sizeof(Hit), "hits"));
    }
    border_rays = context.buffer(work.border.size() * sizeof(Ray), "border rays");
    border_hits = context.buffer(work.border.size() * sizeof(Hit), "hits");
    context.write(border_rays, work.border.data(), work.border.size() * sizeof(Ray));
  }
  uint64_t items(uint64_t rays) const { return (rays + raysPerItem(context) - 1) / raysPerItem(context); }

  OpenClContext context;
  OpenClScene scene;
  ClKernel segment_kernel, rays_kernel;
  std::vector<ClBuffer> random_hits;
  ClBuffer border_rays, border_hits;
};

Contestant openClContestant(const Workload& work, const std::string& device) {
  auto state = std::make_shared<OpenClState>(work, device);
  const uint32_t local = state->context.isCpu() ? 8 : 64;
  return {"opencl",
          [&work, state, local] {
            for (size_t i = 0; i < work.runs.size(); ++i) {
              const Run& run = work.runs[i];
              state->context.launch(state->segment_kernel, state->items(slotCount(run.segment)), local,
                                    state->scene.nodes, state->scene.triangles, state->scene.reach,
                                    run.segment, run.face, kShifts, state->random_hits[i]);
            }
            state->context.finish();
          },
          [&work, state, local] {
            const uint32_t count = uint32_t(work.border.size());
            state->context.launch(state->rays_kernel, state->items(count), local, state->scene.nodes,
                                  state->scene.triangles, state->scene.reach, state->border_rays,
                                  state->border_hits, count);
            state->context.finish();
          },
          [&work, state] {
            std::vector<Hit> hits(work.random.size());
            for (size_t i = 0; i < work.runs.size(); ++i) {
              const Run& run = work.runs[i];
              std::vector<Hit> by_slot(slotCount(run.segment));
              state->context.read(state->random_hits[i], by_slot.data(), by_slot.size() * sizeof(Hit));
              for (uint32_t slot = 0; slot < by_slot.size(); ++slot) {
                const uint32_t offset = slotOffset(run.segment, slot);
                if (offset != kNoTriangle) hits[run.first + offset] = by_slot[slot];
              }
            }
            return hits;
          },
          [&work, state] {
            std::vector<Hit> hits(work.border.size());
            state->context.read(state->border_hits, hits.data(), hits.size() * sizeof(Hit));
            return hits;
          }};
}

Contestant vulkanContestant(const Workload& work, const std::string& device) {
  auto tracer = std::make_shared<VulkanTracer>(device, work.scene, work.bvh, kShifts);
  for (const Run& run : work.runs) tracer->addSegment(run.segment, run.face);
  tracer->setRays(work.border);
  return {"vulkan", [tracer] { tracer->traceSegments(); }, [tracer] { tracer->traceRays(); },
          [&work, tracer] {
            std::vector<Hit> hits(work.random.size());
            for (size_t i = 0; i < work.runs.size(); ++i) {
              const Run& run = work.runs[i];
              const std::vector<Hit> by_slot = tracer->segmentHits(i);
              for (uint32_t slot = 0; slot < by_slot.size(); ++slot) {
                const uint32_t offset = slotOffset(run.segment, slot);
                if (offset != kNoTriangle) hits[run.first + offset] = by_slot[slot];
              }
            }
            return hits;
          },
          [tracer] { return tracer->rayHits(); }};
}

#ifdef SL_HAVE_EMBREE
void traceEmbree(RTCScene scene, const std::vector<Ray>& rays, std::vector<Hit>& hits) {
  tbb::parallel_for(size_t{0}, (rays.size() + kChunk - 1) / kChunk, [&](size_t chunk) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (size_t i = chunk * kChunk; i < std::min(rays.size(), (chunk + 1) * kChunk); ++i) {
      const Ray& ray = rays[i];
      RTCRayHit query{};
      query.ray = {ray.origin.x,
                   ray.origin.y,
                   ray.origin.z,
                   0,
                   ray.direction.x,
                   ray.direction.y,
                   ray.direction.z,
                   0,
                   INFINITY,
                   0xffffffffu,
                   0,
                   0};
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(scene, &context, &query);
      hits[i] = {query.ray.tfar,
                 query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? kNoTriangle : query.hit.primID};
    }
  });
}

Contestant embreeContestant(const Workload& work) {
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene scene = rtcNewScene(device);
  RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const auto& p = work.scene.positions;
  const auto& t = work.scene.triangles;
  std::memcpy(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, p.size()),
              p.data(), p.size() * 12);
  std::memcpy(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, t.size()),
              t.data(), t.size() * 12);
  rtcCommitGeometry(mesh);
  rtcAttachGeometry(scene, mesh);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcCommitScene(scene);
  auto random = std::make_shared<std::vector<Hit>>(work.random.size());
  auto border = std::make_shared<std::vector<Hit>>(work.border.size());
  return {"embree", [&work, scene, random] { traceEmbree(scene, work.random, *random); },
          [&work, scene, border] { traceEmbree(scene, work.border, *border); }, [random] { return *random; },
          [border] { return *border; }};
}
#endif

double now(bool processor_time) {
  timespec time{};
  clock_gettime(processor_time ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &time);
  return double(time.tv_sec) + double(time.tv_nsec) * 1e-9;
}

/// Wall time, or the processor time of all threads divided by the number of cores.
double secondsOf(const std::function<void()>& work, bool processor_time) {
  const double start = now(processor_time);
  work();
  return (now(processor_time) - start) / (processor_time ? std::thread::hardware_concurrency() : 1);
}

/// How hits compare with the last contestant's (Embree, which breaks ties as it likes and has no double
/// path).
struct Agreement {
  size_t equal = 0, ties = 0, other = 0;
};

Agreement compare(const std::vector<Hit>& hits, const std::vector<Hit>& peer) {
  Agreement result;
  for (size_t i = 0; i < hits.size(); ++i) {
    const bool miss = hits[i].triangle == kNoTriangle, peer_miss = peer[i].triangle == kNoTriangle;
    if (hits[i].triangle == peer[i].triangle) {
      ++result.equal;
    } else if (!miss && !peer_miss && std::fabs(hits[i].t - peer[i].t) <= 1e-5f * peer[i].t) {
      ++result.ties;
    } else {
      ++result.other;
    }
  }
  return result;
}

void report(const Options& options, std::vector<Contestant>& contestants, bool border, size_t rays) {
  std::vector<std::vector<double>> seconds(contestants.size());
  for (int run = -1; run < options.runs; ++run) {
    for (size_t i = 0; i < contestants.size(); ++i) {
      const double s = secondsOf(border ? contestants[i].trace_border : contestants[i].trace_random,
                                 options.processor_time);
      if (run >= 0) seconds[i].push_back(s);
    }
  }
  const auto hits_of = [&](Contestant& c) { return border ? c.border_hits() : c.random_hits(); };
  const std::vector<Hit> peer = hits_of(contestants.back());
  const bool has_embree = contestants.back().name == "embree";
  const char* kind = border ? "border" : "random";
  for (std::vector<double>& s : seconds) std::sort(s.begin(), s.end());
  const auto median = [&](size_t i) { return seconds[i][seconds[i].size() / 2]; };
  for (size_t i = 0; i < contestants.size(); ++i) {
    const double speed = double(rays) / median(i) / 1e6;
    const double ratio = has_embree ? median(contestants.size() - 1) / median(i) : 0;
    const double spread = (seconds[i].back() - seconds[i].front()) / median(i);
    const Agreement agreement = compare(hits_of(contestants[i]), peer);
    const double equal = double(agreement.equal) / double(rays);
    if (options.json) {
      fmt::print(
          "{{\"device\":\"{}\",\"rays\":\"{}\",\"mrays_per_s\":{:.3f},\"ratio_to_embree\":{},"
          "\"spread\":{:.3f},\"equal_hits\":{:.7f},\"ties\":{},\"other_differences\":{},\"count\":{}}}\n",
          contestants[i].name, kind, speed, has_embree ? fmt::format("{:.3f}", ratio) : "null", spread, equal,
          agreement.ties, agreement.other, rays);
    } else {
      fmt::print("{:<8} {:<8} {:>8.2f} {:>10} {:>8.1f} {:>12.5f} {:>9} {:>9}\n", contestants[i].name, kind,
                 speed, has_embree ? fmt::format("{:.2f}", ratio) : "-", 100 * spread, 100 * equal,
                 agreement.ties, agreement.other);
    }
    std::fflush(stdout);
  }
}

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    const auto value = [&] {
      if (i + 1 == argc) throw Error(name + " needs a value", kExitUsage);
      return std::string(argv[++i]);
    };
    if (name == "--triangles") {
      options.triangles = std::stoull(value());
    } else if (name == "--rays") {
      options.rays = uint32_t(std::stoul(value()));
    } else if (name == "--runs") {
      options.runs = std::stoi(value());
    } else if (name == "--device") {
      options.device = value();
    } else if (name == "--vulkan") {
      options.vulkan = value();
    } else if (name == "--leaf") {
      options.bvh.max_leaf_size = uint32_t(std::stoul(value()));
    } else if (name == "--spatial") {
      options.bvh.spatial_splits = true;
    } else if (name == "--skip") {
      options.skip = value();
    } else if (name == "--processor-time") {
      options.processor_time = true;
    } else if (name == "--json") {
      options.json = true;
    } else {
      throw Error("unknown argument " + name, kExitUsage);
    }
  }
  if (options.runs < 1 || options.rays < 1) throw Error("--runs and --rays must be at least 1", kExitUsage);
  return options;
}

void run(const Options& options) {
  const Workload work = makeWorkload(options);
  std::vector<Contestant> contestants;
  contestants.push_back(cpuContestant(work));
  if (!listOpenClDevices().empty()) contestants.push_back(openClContestant(work, options.device));
  if (!options.vulkan.empty()) contestants.push_back(vulkanContestant(work, options.vulkan));
#ifdef SL_HAVE_EMBREE
  contestants.push_back(embreeContestant(work));
#endif
  if (!options.json) {
    fmt::print(
        "city of {} triangles, {} random and {} border rays; median of {} runs in turns\n"
        "device   rays      Mrays/s  to Embree spread % equal hits %      ties     other\n",
        work.scene.triangles.size(), work.random.size(), work.border.size(), options.runs);
  }
  report(options, contestants, false, work.random.size());
  report(options, contestants, true, work.border.size());
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  try {
    sightline::run(sightline::parse(argc, argv));
    return 0;
  } catch (const sightline::Error& error) {
    fmt::print(stderr, "bench_trace: {}\n", error.what());
    return error.exitCode();
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_trace: {}\n", error.what());
    return 1;
  }
}
