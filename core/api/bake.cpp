#include "core/api/bake.h"

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

}  // namespace

CellBaker cellBaker(Session& session, const PvsFile& inputs, const BakeEvents& events) {
  const float hole = inputs.params.smallest_hole;
  Device& device = session.parts().device(inputs.params.method, hole);
  std::shared_ptr<Session> open;
  if (!inputs.doors.empty()) {
    SessionOptions options = session.options();
    options.see_through.clear();  // as the session's scene is already
    open = std::make_shared<Session>(seenThrough(session.scene(), inputs.doors), options);
  }
  return [&, open, hole](const ViewCell& cell, uint32_t index, const ProgressCallback& progress) {
    BakeTrace trace;
    CellPvs pvs = bakeCell(device, session.scene(), cell, index, inputs.params,
                           {progress, events.stop, events.grown ? &trace : nullptr});
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

bool runBake(Session& session, Bake& bake, const BakeEvents& events) {
  const CellBaker baker = cellBaker(session, bake.head(), events);
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
