#include "core/draw/cull_pvs.h"

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/draw/frame_recorder.h"
#include "core/draw/visit_frustum.h"

namespace sightline {

namespace {

class PvsListCulled : public CullMethod {
 public:
  PvsListCulled(const DrawScene& scene, const PvsUnits& units, OutsideCells outside)
      : scene_(scene), units_(units), cell_(units, outside) {}

  FrameCounts drawFrame(const Camera& camera, uint64_t number, QueryBackend& backend,
                        std::vector<uint32_t>& drawn) override {
    FrameCounts counts;
    const auto cell = cell_.find(camera, number, counts);
    if (!cell) {
      FrameRecorder frame(scene_.drawables, camera, backend, drawn);
      for (uint32_t d = 0; d < scene_.drawables.list.size(); ++d) frame.draw(d);
      frame.finish();
      frame.counts.outside = counts.outside;
      return frame.counts;
    }
    drawn = units_.drawables[*cell];
    backend.beginFrame(camera);
    const TriangleList& list = units_.triangles.lists[*cell];
    if (!list.ids.empty()) {
      backend.submitList(*cell);
      counts.submits = 1;
      counts.draws = list.draws();
      counts.objects = drawn.size();
      counts.triangles = list.ids.size();
    }
    backend.endFrame();
    return counts;
  }
  void forget() override { cell_.forget(); }

 private:
  const DrawScene& scene_;
  const PvsUnits& units_;
  CameraCell cell_;
};

class PvsFrustumCulled : public CullMethod {
 public:
  PvsFrustumCulled(const DrawScene& scene, const PvsUnits& units, OutsideCells outside)
      : scene_(scene), units_(units), cell_(units, outside) {}

  FrameCounts drawFrame(const Camera& camera, uint64_t number, QueryBackend& backend,
                        std::vector<uint32_t>& drawn) override {
    FrameCounts counts;
    const auto cell = cell_.find(camera, number, counts);
    FrameRecorder frame(scene_.drawables, camera, backend, drawn);
    frame.counts.outside = counts.outside;
    const Frustum& frustum = frame.guard().frustum();
    if (!cell) {
      frame.counts.node_visits =
          visitFrustum(scene_.tree, camera, frustum, [&](const BoxNode& leaf) { frame.draw(leaf.item); });
    } else {
      for (const uint32_t d : units_.drawables[*cell]) {
        ++frame.counts.node_visits;
        if (frustum.sideOf(scene_.drawables.list[d].box) != FrustumSide::outside) frame.draw(d);
      }
    }
    frame.finish();
    return frame.counts;
  }
  void forget() override { cell_.forget(); }

 private:
  const DrawScene& scene_;
  const PvsUnits& units_;
  CameraCell cell_;
};

}  // namespace

std::optional<uint32_t> CameraCell::find(const Camera& camera, uint64_t number, FrameCounts& counts) {
  const glm::dvec3 eye(camera.eye.x, camera.eye.y, camera.eye.z);
  const auto cell = units_.cellAt(eye, last_);
  last_ = cell;
  counts.outside = !cell;
  if (cell || outside_ == OutsideCells::all) return cell;
  if (outside_ == OutsideCells::nearest) return units_.nearestCell(eye);
  throw Error(fmt::format(
      "frame {}: the camera at {}, {}, {} is in no cell of the set: bake cells that hold the path "
      "(cells --walk), or choose what to draw there (--outside all or nearest)",
      number, eye.x, eye.y, eye.z));
}

std::unique_ptr<CullMethod> cullPvsList(const DrawScene& scene, const PvsUnits& units, OutsideCells outside) {
  return std::make_unique<PvsListCulled>(scene, units, outside);
}

std::unique_ptr<CullMethod> cullPvsFrustum(const DrawScene& scene, const PvsUnits& units,
                                           OutsideCells outside) {
  return std::make_unique<PvsFrustumCulled>(scene, units, outside);
}

}  // namespace sightline
