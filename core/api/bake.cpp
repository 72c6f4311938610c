#include "core/api/bake.h"

#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "core/api/bake_steps.h"
#include "core/api/session_parts.h"
#include "core/base/error.h"
#include "core/cell/cell_problem.h"
#include "core/device/registry/device_names.h"
#include "core/gvs/algorithm_revision.h"
#include "core/gvs/find_leaks.h"
#include "core/scene/seen_through.h"

namespace sightline {

PvsFile bakeInputs(Session& session, std::span<const ViewCell> cells, const BakeParams& params,
                   const BakeContent& content) {
  const std::string& device = session.options().device;
  checkParams(params);
  requireMethodOn(params.method, device);
  const glm::dvec3& offset = session.scene().offset;
  std::vector<ViewCell> planned = moved({cells.begin(), cells.end()}, -offset);
  if (const auto problem = cellProblem(planned)) throw Error(problem->text(), kExitUsage);
  const bool draws = params.method == Method::kRaster;
  if (draws && !(content.doors.empty() && session.options().see_through.empty())) {
    throw Error(
        "doors and objects to see through are glass, which the method raster does not draw: use another "
        "method",
        kExitUsage);
  }
  requireDrawable(params.method, session.scene());
  PvsFile inputs;
  inputs.algorithm = kAlgorithmRevision;
  inputs.intersector = intersectorOf(device);
  inputs.scene_hash = session.sceneHash();
  inputs.triangle_count = session.scene().triangleCount();
  inputs.scene_name = session.options().scene_name;
  inputs.params = params;
  inputs.has_witnesses = content.witnesses == Witnesses::kKeep;
  inputs.doors = content.doors;
  inputs.see_through = session.options().see_through;
  inputs.offset = offset;
  inputs.planned = std::move(planned);
  inputs.version = versionOf(inputs);
  return inputs;
}

namespace {

/// What the cell sees besides where the doors hide nothing: what `device` finds, for which they are glass,
/// and not `closed`.
OpenSet bakeOpen(Device& device, const Scene& scene, uint32_t index, const BakeParams& params,
                 const CellPvs& closed, const BakeHooks& hooks) {
  CellPvs pvs = bakeCell(device, scene, closed.cell, index, params, hooks);
  OpenSet open;
  open.stats = pvs.stats;
  for (size_t i = 0; i < pvs.triangles.size(); ++i) {
    if (std::binary_search(closed.triangles.begin(), closed.triangles.end(), pvs.triangles[i])) continue;
    open.triangles.push_back(pvs.triangles[i]);
    open.witnesses.push_back(pvs.witnesses[i]);
  }
  return open;
}

/// The triangles that the bound leaves out for the cell of that name.
std::vector<uint32_t> hiddenBy(const PvsFile& bound, const ViewCell& cell) {
  const auto same = std::ranges::find(bound.cells, cell.name, [](const CellPvs& c) { return c.cell.name; });
  std::vector<uint32_t> hidden;
  auto next = same->triangles.begin();
  for (uint32_t id = 0; id < bound.triangle_count; ++id) {
    if (next != same->triangles.end() && *next == id) {
      ++next;
    } else {
      hidden.push_back(id);
    }
  }
  return hidden;
}

}  // namespace

void requireBound(const PvsFile& bound, const PvsFile& inputs, const std::filesystem::path& file) {
  const auto require = [&](bool good, const std::string& line) {
    if (!good) throw Error(file.string() + ": " + line, kExitUsage);
  };
  require(bound.params.method == Method::kBound, "is no bound: make one with sightline bound");
  require(bound.scene_hash == inputs.scene_hash && bound.triangle_count == inputs.triangle_count,
          "is the bound of another scene, or of another state of it");
  require(inputs.doors.empty(), "bounds are with the doors closed: bake without --doors, or without --bound");
  require(bound.see_through == inputs.see_through,
          "other objects hide nothing there: give bound and bake the same --see-through");
  for (const ViewCell& cell : inputs.planned) {
    const auto same = std::ranges::find(bound.cells, cell.name, [](const CellPvs& c) { return c.cell.name; });
    require(same != bound.cells.end() && same->cell == cell,
            fmt::format("has no cell {} in this place: make the bound with the same cells", cell.name));
  }
}

CellBaker cellBaker(Session& session, const PvsFile& inputs, const BakeEvents& events, const PvsFile* bound) {
  const float hole = inputs.params.smallest_hole;
  Device& device = session.parts().device(inputs.params.method, hole);
  std::shared_ptr<Session> open;
  if (!inputs.doors.empty()) {
    SessionOptions options = session.options();
    options.see_through.clear();  // as the session's scene is already
    open = std::make_shared<Session>(seenThrough(session.scene(), inputs.doors), options);
  }
  return [&, open, hole, bound](const ViewCell& cell, uint32_t index, const ProgressCallback& progress) {
    BakeTrace trace;
    const std::vector<uint32_t> hidden = bound ? hiddenBy(*bound, cell) : std::vector<uint32_t>();
    BakeHooks hooks{progress, events.stop, events.grown ? &trace : nullptr};
    hooks.hidden = hidden;
    CellPvs pvs = bakeCell(device, session.scene(), cell, index, inputs.params, hooks);
    if (events.leaks && hole == 0) {
      events.leaks(index, findLeaks(device, session.scene(), pvs, leakWidth(cell)));
    }
    if (open) {
      Device& glass_doors = open->parts().device(inputs.params.method, hole);
      pvs.open =
          bakeOpen(glass_doors, open->scene(), index, inputs.params, pvs, {progress, events.stop, nullptr});
    }
    if (events.grown) events.grown(index, std::move(trace));
    if (!inputs.has_witnesses) {
      pvs.witnesses.clear();
      if (pvs.open) pvs.open->witnesses.clear();
    }
    return pvs;
  };
}

std::string deviceText(Session& session) {
  const DeviceInfo info = session.device();
  return info.id + ", " + info.name;
}

bool runBake(Session& session, Bake& bake, const BakeEvents& events, const PvsFile* bound) {
  const CellBaker baker = cellBaker(session, bake.head(), events, bound);
  return bake.run(deviceText(session), baker, events);
}

PvsFile bake(Session& session, std::span<const ViewCell> cells, const BakeParams& params,
             const BakeEvents& events, const BakeContent& content) {
  PvsFile pvs = bakeInputs(session, cells, params, content);
  const CellBaker baker = cellBaker(session, pvs, events);
  const std::string device = deviceText(session);
  for (uint32_t index = 0; index < pvs.planned.size(); ++index) {
    if (events.stop && *events.stop) return pvs;
    try {
      pvs.cells.push_back(baker(pvs.planned[index], index, [&](const BakeProgress& progress) {
        if (events.progress) events.progress(index, progress);
      }));
    } catch (const Interrupted&) {
      return pvs;
    }
    pvs.cells.back().device = pvs.device = device;
    if (events.cell_done) events.cell_done(index, pvs.cells.back());
  }
  return pvs;
}

bool bakeToFile(Session& session, std::span<const ViewCell> cells, const BakeOutput& output,
                const BakeParams& params, const BakeEvents& events) {
  Bake bake(bakeInputs(session, cells, params, output.content), output.file, output.overwrite);
  return bake.complete() || runBake(session, bake, events);
}

}  // namespace sightline
