#pragma once
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "core/pvs/pvs_file.h"
#include "tests/support/temporary_folder.h"

namespace sightline {

inline std::vector<uint8_t> readBytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void writeBytes(const std::filesystem::path& file, const std::vector<uint8_t>& bytes) {
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
}

/// The file up to what may differ between two equal bakes: times, memory, device. All of it if there is none.
inline std::vector<uint8_t> bytesBeforeCosts(const std::filesystem::path& file) {
  std::vector<uint8_t> bytes = readBytes(file);
  for (size_t section = 16; section + 16 <= bytes.size();) {
    uint64_t size = 0;
    std::memcpy(&size, bytes.data() + section + 8, sizeof size);
    if (std::memcmp(bytes.data() + section, "COST", 4) == 0) {
      bytes.resize(section);
      break;
    }
    section += 16 + size + 8;
  }
  return bytes;
}

inline CellPvs exampleCell(const ViewCell& cell, std::vector<uint32_t> ids, bool witnesses) {
  CellPvs pvs;
  pvs.cell = cell;
  pvs.device = "cpu";
  pvs.stats.random = {1000, ids.size(), 0.5};
  pvs.stats.border = {2000, 3, 0.25};
  pvs.stats.reverse = {30, 1, 0.125};
  pvs.stats.contained_triangles = 2;
  pvs.stats.iterations = 4;
  pvs.stats.stop = StopReason::kRayLimit;
  pvs.stats.validation_rays = 500;
  pvs.stats.missing_rays = 1;
  pvs.stats.bound_rays = 1u << 20;
  pvs.stats.bound_tests = 3;
  pvs.stats.error_bound = 0.0625;
  pvs.stats.seconds = 1.5;
  pvs.stats.peak_device_bytes = 1 << 20;
  pvs.triangles = std::move(ids);
  if (witnesses) {
    for (uint32_t id : pvs.triangles) {
      pvs.witnesses.push_back({glm::vec3(float(id), 1, 2), glm::vec3(-1, float(id), 0.5f), id % 4});
    }
  }
  return pvs;
}

/// Two cells of three planned; the second set is empty.
inline PvsFile examplePvs(bool witnesses = true) {
  PvsFile pvs;
  pvs.algorithm = 7;
  pvs.intersector = "GPU, driver 5";
  pvs.scene_hash = 0x0123456789abcdefu;
  pvs.triangle_count = 1000;
  pvs.scene_name = "courtyard.obj";
  pvs.device = "cpu";
  pvs.params.method = Method::kRandom;
  pvs.params.n_rand = 4321;
  pvs.params.delta_abs = 0.001f;
  pvs.params.max_seconds = 12.5;
  pvs.params.seed = 77;
  pvs.params.raster_resolution = 640;
  pvs.params.target_error = 0.125;
  pvs.params.abs_spacing = 0.25f;
  pvs.params.reverse_stride = 3;
  pvs.params.order = Order::kQueue;
  pvs.has_witnesses = witnesses;
  pvs.planned = {{"a", {1, 2, 3}, {4, 5, 0}, {6, 7, 8}},
                 {"b-\xc3\xa9", {0, 0, 0}, {1, 1, 1}, {0, 0, 0}},
                 {"c", {9, 0, 0}, {1, 1, 1}, {0, 45, 0}}};
  pvs.cells = {exampleCell(pvs.planned[0], {0, 1, 2, 7, 300, 998, 999}, witnesses),
               exampleCell(pvs.planned[1], {}, witnesses)};
  return pvs;
}

}  // namespace sightline
