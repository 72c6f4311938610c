#include "core/draw/cull_pvs.h"

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/draw/cull_methods.h"
#include "core/draw/frame_recorder.h"

namespace sightline {

namespace {

/// Outside of cells like another method.
class PvsCulled : public CullMethod {
 public:
  PvsCulled(const PvsUnits& units, const CellChoice& choice, std::unique_ptr<CullMethod> outside)
      : units_(units), cell_(units, choice), outside_(std::move(outside)) {}

  FrameCounts drawFrame(const Camera& camera, uint64_t number, QueryBackend& backend,
                        std::vector<uint32_t>& drawn) final {
    FrameCounts found;
    const auto cell = cell_.find(camera, number, found);
    FrameCounts counts =
        cell ? drawCell(*cell, camera, backend, drawn) : outside_->drawFrame(camera, number, backend, drawn);
    counts.outside = found.outside;
    return counts;
  }
  void forget() override { cell_.forget(); }

 protected:
  virtual FrameCounts drawCell(uint32_t cell, const Camera& camera, QueryBackend& backend,
                               std::vector<uint32_t>& drawn) = 0;
  const PvsUnits& units_;

 private:
  CameraCell cell_;
  std::unique_ptr<CullMethod> outside_;
};

class PvsListCulled : public PvsCulled {
 public:
  PvsListCulled(const DrawScene& scene, const PvsUnits& units, const CellChoice& choice)
      : PvsCulled(units, choice, cullNothing(scene)) {}

 private:
  FrameCounts drawCell(uint32_t cell, const Camera& camera, QueryBackend& backend,
                       std::vector<uint32_t>& drawn) override {
    FrameCounts counts;
    drawn = units_.drawables[cell];
    backend.beginFrame(camera);
    const TriangleList& list = units_.triangles.lists[cell];
    if (!list.ids.empty()) {
      backend.submitList(cell);
      counts.submits = 1;
      counts.draws = list.draws();
      counts.objects = drawn.size();
      counts.triangles = list.ids.size();
    }
    backend.endFrame();
    return counts;
  }
};

class PvsFrustumCulled : public PvsCulled {
 public:
  PvsFrustumCulled(const DrawScene& scene, const PvsUnits& units, const CellChoice& choice)
      : PvsCulled(units, choice, cullFrustum(scene)), scene_(scene) {}

 private:
  FrameCounts drawCell(uint32_t cell, const Camera& camera, QueryBackend& backend,
                       std::vector<uint32_t>& drawn) override {
    FrameRecorder frame(scene_.drawables, camera, backend, drawn);
    for (const uint32_t d : units_.drawables[cell]) {
      ++frame.counts.node_visits;
      const AxisBox& box = scene_.drawables.list[d].box;
      if (frame.guard().frustum().sideOf(box) != FrustumSide::outside) frame.draw(d);
    }
    frame.finish();
    return frame.counts;
  }

  const DrawScene& scene_;
};

}  // namespace

std::optional<uint32_t> CameraCell::find(const Camera& camera, uint64_t number, FrameCounts& counts) {
  if (!choice_.of_frames.empty()) return choice_.of_frames[number];
  const glm::dvec3 eye(camera.eye.x, camera.eye.y, camera.eye.z);
  const auto cell = units_.cellAt(eye, last_);
  last_ = cell;
  counts.outside = !cell;
  if (cell || choice_.outside == OutsideCells::all) return cell;
  if (choice_.outside == OutsideCells::nearest) return units_.nearestCell(eye);
  throw Error(fmt::format(
      "frame {}: the camera at {}, {}, {} is in no cell of the set: bake cells that hold the path "
      "(cells --walk), or choose what to draw there (--outside all or nearest)",
      number, eye.x, eye.y, eye.z));
}

std::unique_ptr<CullMethod> cullPvsList(const DrawScene& scene, const PvsUnits& units,
                                        const CellChoice& choice) {
  return std::make_unique<PvsListCulled>(scene, units, choice);
}

std::unique_ptr<CullMethod> cullPvsFrustum(const DrawScene& scene, const PvsUnits& units,
                                           const CellChoice& choice) {
  return std::make_unique<PvsFrustumCulled>(scene, units, choice);
}

}  // namespace sightline
