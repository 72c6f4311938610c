#include "core/voxel/voxel_file.h"

#include <gtest/gtest.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <functional>
#include <optional>
#include <random>
#include <set>

#include "core/base/error.h"
#include "core/pvs/pvs_sections.h"
#include "core/pvs/set_codec.h"
#include "core/voxel/voxelize.h"
#include "tests/support/random_triangles.h"
#include "tests/support/temporary_folder.h"

namespace sightline {
namespace {

Scene soupScene(uint32_t seed) {
  testing_support::Random random(seed);
  Scene scene = testing_support::soup(random, 300, 0.3f, 0.5f);
  scene.objects.push_back({"all", 0, scene.triangleCount()});
  return scene;
}

VoxelFile voxelsOf(const Scene& scene, double size, bool with_all) {
  const VoxelizeOptions options{.lattice = latticeOf(size),
                                .separation = with_all ? Separation::k6 : Separation::kConservative,
                                .with_triangles = with_all,
                                .attributes = {.normals = with_all, .objects = with_all}};
  VoxelFile file{headOf(scene, options), {}};
  file.levels = pyramidOf(voxelize(scene, options));
  return file;
}

std::vector<VoxelLevelCounts> write(const VoxelFile& content, const std::filesystem::path& file) {
  VoxelWriter writer(file, content.head);
  for (VoxelBlock block : content.levels.front().blocks) writer.add(std::move(block));
  return writer.finish();
}

std::vector<uint8_t> bytesOf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(VoxelFile, ComesBackAsItWasWritten) {
  const TemporaryFolder folder;
  for (const bool with_triangles : {false, true}) {
    const VoxelFile content = voxelsOf(soupScene(1), 0x1p-6, with_triangles);
    ASSERT_GT(content.levels.front().blocks.size(), 8u);
    const auto counts = write(content, folder / "a.slv");
    const VoxelFile read = loadVoxels(folder / "a.slv");
    EXPECT_EQ(read.head, content.head);
    ASSERT_EQ(read.levels.size(), content.levels.size());
    ASSERT_EQ(counts.size(), content.levels.size());
    for (size_t level = 0; level < read.levels.size(); ++level) {
      EXPECT_EQ(read.levels[level].blocks, content.levels[level].blocks) << level;
      EXPECT_EQ(read.levels[level].lattice, content.levels[level].lattice) << level;
      EXPECT_EQ(counts[level].voxels, content.levels[level].count()) << level;
    }
    EXPECT_LT(double(counts[0].geometry_bytes), 1.5 * double(counts[0].voxels));
  }
}

// Whatever is cut off or changed is said to be damaged; nothing is read that is not there.
TEST(VoxelFile, EveryCutAndEveryChangedByteIsFound) {
  const TemporaryFolder folder;
  write(voxelsOf(soupScene(2), 0.25, true), folder / "a.slv");
  const std::vector<uint8_t> whole = bytesOf(folder / "a.slv");
  ASSERT_NO_THROW(parseVoxels(whole, "a.slv"));
  for (size_t size = 0; size < whole.size(); ++size) {
    EXPECT_THROW(parseVoxels(std::span(whole).first(size), "a.slv"), Error) << size;
  }
  for (size_t at = 0; at < whole.size(); ++at) {
    std::vector<uint8_t> changed = whole;
    changed[at] ^= 0x10;
    EXPECT_THROW(parseVoxels(changed, "a.slv"), Error) << at;
  }
}

struct Section {
  uint32_t kind;
  Bytes payload;
};

std::vector<Section> sectionsOf(const std::vector<uint8_t>& bytes) {
  std::vector<Section> sections;
  for (size_t at = kPvsPreludeBytes; at < bytes.size();) {
    ByteReader in(std::span<const uint8_t>(bytes).subspan(at));
    const auto kind = in.number<uint32_t>();
    in.number<uint32_t>();
    const auto size = in.number<uint64_t>();
    const auto payload = in.raw(size);
    sections.push_back({kind, Bytes(payload.begin(), payload.end())});
    at += kSectionHeadBytes + size + kSectionChecksumBytes;
  }
  return sections;
}

// With checksums that fit.
Bytes joined(std::span<const uint8_t> prelude, std::vector<Section> sections) {
  Bytes all(prelude.begin(), prelude.end());
  for (Section& section : sections) {
    if (section.kind == kSectionEnd && section.payload.size() >= 12) {
      const uint64_t checksum = XXH3_64bits(all.data(), all.size());
      std::memcpy(section.payload.data() + sizeof(uint32_t), &checksum, sizeof checksum);
    }
    const Bytes part = writeSection(section.kind, section.payload);
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

// Changes, cuts or lengthens the bytes.
void damage(Bytes& bytes, std::mt19937_64& random) {
  const uint64_t what = random() % 8;
  if (bytes.empty() || what == 0) {
    bytes.push_back(uint8_t(random()));
  } else if (what == 1) {
    bytes.resize(random() % bytes.size());
  } else {
    const uint64_t changes = 1 + random() % 3;
    for (uint64_t i = 0; i < changes; ++i) bytes[random() % bytes.size()] ^= uint8_t(1 + random() % 255);
  }
}

// Damage that no checksum shows, packed parts included: an error, or a file that keeps its promises.
TEST(VoxelFile, DamageBehindGoodChecksumsBreaksNoPromise) {
  const TemporaryFolder folder;
  write(voxelsOf(soupScene(9), 0x1p-3, true), folder / "a.slv");
  const std::vector<uint8_t> whole = bytesOf(folder / "a.slv");
  const auto prelude = std::span(whole).first(kPvsPreludeBytes);
  const std::vector<Section> sections = sectionsOf(whole);
  ASSERT_EQ(joined(prelude, sections), Bytes(whole.begin(), whole.end()));
  std::mt19937_64 random(10);
  int read = 0, refused = 0;
  for (int i = 0; i < 4000; ++i) {
    std::vector<Section> damaged = sections;
    const size_t at = random() % damaged.size();
    Bytes& payload = damaged[at].payload;
    const size_t packed_from = damaged[at].kind == kSectionHead || damaged[at].kind == kSectionEnd
                                   ? payload.size()
                               : at % 3 == 0 ? 0
                                             : 8;
    auto content = packed_from < payload.size() ? decompress(std::span(payload).subspan(packed_from), 1 << 24)
                                                : std::optional<Bytes>();
    if (content && i % 4 != 0) {
      damage(*content, random);
      payload.resize(packed_from);
      const Bytes frame = compress(*content);
      payload.insert(payload.end(), frame.begin(), frame.end());
    } else {
      damage(payload, random);
    }
    try {
      const VoxelFile file = parseVoxels(joined(prelude, damaged), "a.slv");
      ++read;
      for (const VoxelGrid& level : file.levels) {
        ASSERT_FALSE(level.blocks.empty());
        for (size_t k = 0; k < level.blocks.size(); ++k) {
          const VoxelBlock& block = level.blocks[k];
          ASSERT_TRUE(k == 0 || placeBefore(level.blocks[k - 1].place, block.place));
          ASSERT_EQ(std::ranges::adjacent_find(block.triangles, std::greater_equal<>()),
                    block.triangles.end());
          ASSERT_TRUE(block.triangles.empty() || block.triangles.back() < file.head.triangle_count);
          ASSERT_TRUE(block.normals.empty() || block.normals.size() == block.count());
          ASSERT_FALSE(block.bricks.empty());
        }
      }
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(read, 100);
  EXPECT_GT(refused, 1000);
}

TEST(VoxelFile, NothingIsLeftOfOneThatIsNotFinished) {
  const TemporaryFolder folder;
  { VoxelWriter writer(folder / "a.slv", headOf(soupScene(3), {.lattice = latticeOf(0.25)})); }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(VoxelFile, IsOfItsScene) {
  const Scene scene = soupScene(4), other = soupScene(5);
  const VoxelHead head = headOf(scene, {.lattice = latticeOf(1)});
  EXPECT_NO_THROW(requireScene(head, hashScene(scene), "a.slv"));
  EXPECT_THROW(requireScene(head, hashScene(other), "a.slv"), Error);
}

std::set<std::array<int, 3>> placesIn(const VoxelGrid& grid) {
  std::set<std::array<int, 3>> places;
  for (const VoxelBlock& block : grid.blocks) {
    BlockBits bits;
    bits.insert(block.bricks);
    for (int z = 0; z < 64; ++z) {
      for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
          if ((bits.row(y, z) >> x) & 1)
            places.insert({64 * block.place.x + x, 64 * block.place.y + y, 64 * block.place.z + z});
        }
      }
    }
  }
  return places;
}

// Right: a voxel of a level is in it if one of its eight is in the level below.
TEST(Pyramid, HoldsWhoeverHasAChild) {
  const VoxelFile file = voxelsOf(soupScene(6), 0x1p-5, true);
  ASSERT_GT(file.levels.size(), 5u);
  for (size_t level = 0; level + 1 < file.levels.size(); ++level) {
    std::set<std::array<int, 3>> expected;
    for (const auto& p : placesIn(file.levels[level])) expected.insert({p[0] >> 1, p[1] >> 1, p[2] >> 1});
    EXPECT_EQ(placesIn(file.levels[level + 1]), expected) << level;
    for (size_t i = 1; i < file.levels[level].blocks.size(); ++i) {
      EXPECT_TRUE(placeBefore(file.levels[level].blocks[i - 1].place, file.levels[level].blocks[i].place));
    }
  }
  EXPECT_TRUE(isRoot(file.levels.back()));
  EXPECT_FALSE(isRoot(file.levels[file.levels.size() - 2]));
  EXPECT_LE(file.levels.back().count(), 8u);
}

// The coarser level of a scene's voxels is not more than the scene's coarser voxels: what meets a large cube
// meets one of its eight.
TEST(Pyramid, IsTheSceneVoxelizedCoarser) {
  const Scene scene = soupScene(7);
  const VoxelGrid fine = voxelize(scene, {.lattice = latticeOf(0x1p-5), .with_triangles = false});
  const VoxelGrid coarse = voxelize(scene, {.lattice = latticeOf(0x1p-4), .with_triangles = false});
  EXPECT_EQ(coarser(fine).blocks, coarse.blocks);
}

TEST(VoxelGrid, KnowsItsBox) {
  const VoxelGrid grid = voxelize(soupScene(8), {.lattice = latticeOf(0x1p-5)});
  VoxelBox expected{glm::ivec3(1 << 20), glm::ivec3(-(1 << 20))};
  for (const auto& p : placesIn(grid)) {
    const glm::ivec3 place(p[0], p[1], p[2]);
    expected = {glm::min(expected.low, place), glm::max(expected.high, place)};
  }
  EXPECT_EQ(boxOf(grid).low, expected.low);
  EXPECT_EQ(boxOf(grid).high, expected.high);
}

}  // namespace
}  // namespace sightline
