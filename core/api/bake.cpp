#include "core/api/bake.h"

#include "core/api/bake_steps.h"
#include "core/api/session_parts.h"
#include "core/base/error.h"
#include "core/cell/cell_problem.h"
#include "core/device/registry/device_names.h"
#include "core/gvs/algorithm_revision.h"

namespace sightline {

PvsFile bakeInputs(Session& session, std::span<const ViewCell> cells, const BakeParams& params,
                   Witnesses witnesses) {
  const std::string& device = session.options().device;
  checkParams(params);
  requireMethodOn(params.method, device);
  const glm::dvec3& offset = session.scene().offset;
  std::vector<ViewCell> planned = moved({cells.begin(), cells.end()}, -offset);
  if (const auto problem = cellProblem(planned)) throw Error(problem->text(), kExitUsage);
  PvsFile inputs;
  inputs.algorithm = kAlgorithmRevision;
  inputs.intersector = intersectorOf(device);
  inputs.scene_hash = session.sceneHash();
  inputs.triangle_count = session.scene().triangleCount();
  inputs.scene_name = session.options().scene_name;
  inputs.params = params;
  inputs.has_witnesses = witnesses == Witnesses::kKeep;
  inputs.offset = offset;
  inputs.planned = std::move(planned);
  return inputs;
}

CellBaker cellBaker(Session& session, const PvsFile& inputs, const BakeEvents& events) {
  Device& device = session.parts().device(inputs.params.method);
  return [&](const ViewCell& cell, uint32_t index, const ProgressCallback& progress) {
    BakeTrace trace;
    CellPvs pvs = bakeCell(device, session.scene(), cell, index, inputs.params,
                           {progress, events.stop, events.grown ? &trace : nullptr});
    if (events.grown) events.grown(index, std::move(trace));
    if (!inputs.has_witnesses) pvs.witnesses.clear();
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
             const BakeEvents& events, Witnesses witnesses) {
  PvsFile pvs = bakeInputs(session, cells, params, witnesses);
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
  Bake bake(bakeInputs(session, cells, params, output.witnesses), output.file, output.overwrite);
  return bake.complete() || runBake(session, bake, events);
}

}  // namespace sightline
