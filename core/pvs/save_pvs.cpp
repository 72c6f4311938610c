#include "core/io/file_io.h"
#include "core/pvs/checksum.h"
#include "core/pvs/pvs_file.h"
#include "core/pvs/pvs_sections.h"

namespace sightline {

void writePvs(const PvsFile& pvs, const std::function<void(const Bytes&)>& put) {
  Checksum checksum;
  const auto write = [&](const Bytes& bytes) {
    put(bytes);
    checksum.add(bytes);
  };
  write(writePrelude(kPvsMagic, versionOf(pvs)));
  write(writeSection(kSectionHead, writeHeadPayload(pvs)));
  ByteWriter costs;
  for (uint32_t index = 0; index < pvs.cells.size(); ++index) {
    const CellPvs& cell = pvs.cells[index];
    write(writeSection(kSectionCell, writeCellPayload(cell, index, pvs)));
    writeCost(costs, costOf(cell, index), pvs);
  }
  write(writeSection(kSectionCost, costs.bytes()));
  write(writeSection(kSectionEnd, writeEndPayload(uint32_t(pvs.cells.size()), checksum.value())));
}

void savePvs(const PvsFile& pvs, const std::filesystem::path& file) {
  OutputFile output(file);
  writePvs(pvs, [&output](const Bytes& bytes) { output.write(bytes.data(), bytes.size()); });
  output.commit();
}

}  // namespace sightline
