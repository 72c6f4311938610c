#pragma once
#include <span>
#include <string>

#include "core/api/bake.h"
#include "core/bake/bake.h"

// The steps of core/api/bake.h, for those who say something between them.
namespace sightline {

/// The inputs, as the head of the file that is to be made. Checks the parameters, and the session's device as
/// far as it decides the result; does not open it. Throws Error.
PvsFile bakeInputs(Session& session, std::span<const ViewCell> cells, const BakeParams& params,
                   const BakeContent& content);

/// Bakes single cells of these inputs on the session's device, which it opens. Session, inputs, events and
/// bound must outlive it. bound: of requireBound; what it proves hidden is left out of the sets.
CellBaker cellBaker(Session& session, const PvsFile& inputs, const BakeEvents& events,
                    const PvsFile* bound = nullptr);

/// Throws Error unless `bound`, read from `file`, is one (method bound) for all cells of these inputs, in
/// which as much hides nothing.
void requireBound(const PvsFile& bound, const PvsFile& inputs, const std::filesystem::path& file);

/// "cpu, Intel Xeon ...": the session's device, as .pvs files name it.
std::string deviceText(Session& session);

/// Bakes what `bake`, of bakeInputs, still lacks. As Bake::run.
bool runBake(Session& session, Bake& bake, const BakeEvents& events, const PvsFile* bound = nullptr);

}  // namespace sightline
