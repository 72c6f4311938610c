#include "core/io/file_io.h"
#include "core/pvs/checksum.h"
#include "core/pvs/pvs_file.h"
#include "core/pvs/pvs_sections.h"

namespace sightline {

void savePvs(const PvsFile& pvs, const std::filesystem::path& file) {
  OutputFile output(file);
  Checksum checksum;
  const auto write = [&](const Bytes& bytes) {
    output.write(bytes.data(), bytes.size());
    checksum.add(bytes);
  };
  write(writePrelude());
  write(writeSection(kSectionHead, writeHeadPayload(pvs)));
  ByteWriter costs;
  for (uint32_t index = 0; index < pvs.cells.size(); ++index) {
    const CellPvs& cell = pvs.cells[index];
    write(writeSection(kSectionCell, writeCellPayload(cell, index, pvs.has_witnesses)));
    writeCost(costs, costOf(cell, index));
  }
  write(writeSection(kSectionCost, costs.bytes()));
  write(writeSection(kSectionEnd, writeEndPayload(uint32_t(pvs.cells.size()), checksum.value())));
  output.commit();
}

}  // namespace sightline
