#include "core/voxel/voxel_file.h"

#include <fmt/format.h>

#include <cstring>
#include <optional>

#include "core/base/error.h"
#include "core/io/byte_stream.h"
#include "core/io/varint.h"
#include "core/pvs/pvs_sections.h"
#include "core/pvs/set_codec.h"

namespace sightline {
namespace {

constexpr uint32_t kSectionBlocks = 0x4b4f4c42;      // "BLOK"
constexpr uint32_t kSectionTriangles = 0x53495254;   // "TRIS"
constexpr uint32_t kSectionAttributes = 0x52545441;  // "ATTR"
constexpr size_t kBlocksAChunk = 64;
constexpr int kBricksABlock = 512;
constexpr int kMostLevels = 32;
// More than what 64 blocks of full bricks take: what claims more is damage.
constexpr uint64_t kMostChunkAttributes = uint64_t(kBlocksAChunk) * kBricksABlock * 512 * 8;
constexpr uint64_t kMostChunkBytes = uint64_t(kBlocksAChunk) * (16 + kBricksABlock * 66);

Bytes headPayload(const VoxelHead& head) {
  ByteWriter out;
  out.number(int32_t(head.lattice.exponent));
  out.number(uint32_t(head.separation));
  out.number(uint32_t(head.has_triangles) | uint32_t(head.has_normals) << 1 |
             uint32_t(head.has_objects) << 2 | uint32_t(head.is_solid) << 3);
  out.number(head.scene_hash);
  out.number(head.triangle_count);
  for (int axis = 0; axis < 3; ++axis) out.number(head.offset[axis]);
  return out.bytes();
}

VoxelHead readHead(std::span<const uint8_t> payload) {
  ByteReader in(payload);
  VoxelHead head;
  head.lattice.exponent = in.number<int32_t>();
  const uint32_t separation = in.number<uint32_t>(), parts = in.number<uint32_t>();
  head.separation = Separation(separation);
  head.has_triangles = (parts & 1) != 0;
  head.has_normals = (parts & 2) != 0;
  head.has_objects = (parts & 4) != 0;
  head.is_solid = (parts & 8) != 0;
  head.scene_hash = in.number<uint64_t>();
  head.triangle_count = in.number<uint32_t>();
  for (int axis = 0; axis < 3; ++axis) head.offset[axis] = in.number<double>();
  if (!in.finished() || parts > 15 || separation > uint32_t(Separation::k6))
    throw Damage("the head is not as long as it should be, or of a later version");
  if (head.lattice.exponent < -100 || head.lattice.exponent > 100) {
    throw Damage(fmt::format("a voxel of 2^{} is out of range", head.lattice.exponent));
  }
  return head;
}

// Places, then bricks, then bits: like beside like packs better.
Bytes blocksPayload(uint32_t level, std::span<const VoxelBlock> blocks) {
  ByteWriter raw;
  for (const VoxelBlock& block : blocks) {
    for (int axis = 0; axis < 3; ++axis) raw.number(int32_t(block.place[axis]));
    raw.number(uint32_t(block.bricks.size()));
  }
  for (const VoxelBlock& block : blocks) {
    for (const VoxelBrick& brick : block.bricks) raw.number(brick.place);
  }
  for (const VoxelBlock& block : blocks) {
    for (const VoxelBrick& brick : block.bricks) {
      for (const uint64_t layer : brick.bits) raw.number(layer);
    }
  }
  ByteWriter out;
  out.number(level);
  out.number(uint32_t(blocks.size()));
  out.raw(compress(raw.bytes()));
  return out.bytes();
}

// A block's ids as gaps to the one before, less 1.
Bytes trianglesPayload(std::span<const VoxelBlock> blocks) {
  Bytes raw;
  for (const VoxelBlock& block : blocks) {
    appendVarint(raw, uint32_t(block.triangles.size()));
    uint32_t next = 0;
    for (const uint32_t id : block.triangles) {
      appendVarint(raw, id - next);
      next = id + 1;
    }
  }
  ByteWriter out;
  out.number(uint64_t(raw.size()));
  out.raw(compress(raw));
  return out.bytes();
}

// Of a block after the other: normals, then objects.
Bytes attributesPayload(std::span<const VoxelBlock> blocks) {
  ByteWriter raw;
  for (const VoxelBlock& block : blocks) {
    for (const uint32_t normal : block.normals) raw.number(normal);
  }
  for (const VoxelBlock& block : blocks) {
    for (const uint32_t object : block.objects) raw.number(object);
  }
  return compress(raw.bytes());
}

void readAttributes(const VoxelHead& head, std::span<const uint8_t> payload, std::span<VoxelBlock> blocks) {
  const auto raw = decompress(payload, kMostChunkAttributes);
  if (!raw) throw Damage("attributes that cannot be unpacked");
  ByteReader content(*raw);
  const auto readAll = [&](std::vector<uint32_t> VoxelBlock::*values) {
    for (VoxelBlock& block : blocks) {
      const uint64_t count = block.count();
      if (count * 4 > content.left()) throw Damage("attributes that are cut off");
      (block.*values).resize(count);
      for (uint32_t& value : block.*values) value = content.number<uint32_t>();
    }
  };
  if (head.has_normals) readAll(&VoxelBlock::normals);
  if (head.has_objects) readAll(&VoxelBlock::objects);
  if (!content.finished()) throw Damage("more attributes than voxels");
}

void readBrick(ByteReader& in, VoxelBrick& brick, bool& any) {
  uint64_t all = 0;
  for (uint64_t& layer : brick.bits) all |= layer = in.number<uint64_t>();
  any = all != 0;
}

std::vector<VoxelBlock> readBlocks(ByteReader& in, uint32_t count) {
  const auto raw = decompress(in.raw(in.left()), kMostChunkBytes);
  if (!raw) throw Damage("blocks that cannot be unpacked");
  ByteReader content(*raw);
  std::vector<VoxelBlock> blocks(count);
  std::vector<uint32_t> bricks(count);
  for (uint32_t i = 0; i < count; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      blocks[i].place[axis] = content.number<int32_t>();
      if (std::abs(int64_t(blocks[i].place[axis])) > kLargestVoxelPlace / kBlockSide) {
        throw Damage("a block that is too far out");
      }
    }
    bricks[i] = content.number<uint32_t>();
    if (content.failed() || bricks[i] == 0 || bricks[i] > uint32_t(kBricksABlock)) {
      throw Damage(fmt::format("a block of {} bricks: expected 1 .. {}", bricks[i], kBricksABlock));
    }
    if (i > 0 && !placeBefore(blocks[i - 1].place, blocks[i].place))
      throw Damage("blocks that are out of order");
  }
  for (uint32_t i = 0; i < count; ++i) {
    blocks[i].bricks.resize(bricks[i]);
    int last = -1;
    for (VoxelBrick& brick : blocks[i].bricks) {
      brick.place = content.number<uint16_t>();
      if (brick.place >= kBricksABlock || int(brick.place) <= last)
        throw Damage("bricks that are out of order");
      last = brick.place;
    }
  }
  for (VoxelBlock& block : blocks) {
    for (VoxelBrick& brick : block.bricks) {
      bool any = false;
      readBrick(content, brick, any);
      if (!any) throw Damage("a brick without a voxel");
    }
  }
  if (!content.finished()) throw Damage("blocks that are cut off");
  return blocks;
}

void readTriangles(std::span<const uint8_t> payload, std::span<VoxelBlock> blocks, uint32_t triangle_count) {
  ByteReader in(payload);
  const uint64_t size = in.number<uint64_t>();
  const auto raw = decompress(in.raw(in.left()), size);
  if (!raw || raw->size() != size) throw Damage("ids that cannot be unpacked");
  size_t at = 0;
  for (VoxelBlock& block : blocks) {
    const auto count = readVarint(*raw, at);
    if (!count || *count == 0 || *count > raw->size() - at)
      throw Damage("a block without ids, or with too many");
    uint64_t next = 0;
    block.triangles.reserve(*count);
    for (uint32_t i = 0; i < *count; ++i) {
      const auto gap = readVarint(*raw, at);
      if (!gap || next + *gap >= triangle_count) throw Damage("an id that the scene does not have");
      block.triangles.push_back(uint32_t(next + *gap));
      next += uint64_t(*gap) + 1;
    }
  }
  if (at != raw->size()) throw Damage("more ids than blocks");
}

void checkPrelude(std::span<const uint8_t> bytes) {
  ByteReader in(bytes);
  const auto magic = in.raw(sizeof(kVoxelMagic));
  const uint32_t version = in.number<uint32_t>();
  in.number<uint32_t>();
  if (magic.size() != sizeof(kVoxelMagic) ||
      std::memcmp(magic.data(), kVoxelMagic, sizeof(kVoxelMagic)) != 0) {
    throw Damage("no voxel file: make one with voxels");
  }
  if (in.failed()) throw Damage("the file is cut off here");
  if (version != kVoxelVersion) {
    throw Damage(fmt::format("version {} of the format: this program reads {}", version, kVoxelVersion));
  }
}

// Adds a chunk to its level, which follows the chunk before it or the level before.
void addBlocks(VoxelFile& file, uint32_t level, std::vector<VoxelBlock>&& blocks) {
  if (level == file.levels.size() && level < kMostLevels) {
    file.levels.push_back({.lattice = {file.head.lattice.exponent + int(level)}, .blocks = {}});
  } else if (level + 1 != file.levels.size()) {
    throw Damage(fmt::format("blocks of level {} at the wrong place", level));
  }
  std::vector<VoxelBlock>& all = file.levels.back().blocks;
  if (!all.empty() && !placeBefore(all.back().place, blocks.front().place))
    throw Damage("blocks that are out of order");
  std::ranges::move(blocks, std::back_inserter(all));
}

// at: how far it has come, for who says what is wrong.
VoxelFile parse(std::span<const uint8_t> bytes, uint64_t& at) {
  checkPrelude(bytes);
  at = kPvsPreludeBytes;
  const auto next = [&] {
    const Section section = readSection(bytes, at);
    at = section.end;
    return section;
  };
  VoxelFile file;
  uint32_t chunks = 0;
  const Section head = next();
  if (head.kind != kSectionHead) throw Damage("the head is missing");
  file.head = readHead(head.payload);
  while (true) {
    const Section section = next();
    ByteReader in(section.payload);
    if (section.kind == kSectionEnd) {
      const uint32_t count = in.number<uint32_t>();
      const uint64_t checksum = in.number<uint64_t>();
      if (!in.finished() || count != chunks || checksum != XXH3_64bits(bytes.data(), section.offset)) {
        throw Damage("the end does not fit the file");
      }
      if (at != bytes.size()) throw Damage("bytes after the end");
      return file;
    }
    const uint32_t level = in.number<uint32_t>(), count = in.number<uint32_t>();
    if (section.kind != kSectionBlocks || in.failed() || count == 0 || count > kBlocksAChunk)
      throw Damage("a section of an unknown kind");
    std::vector<VoxelBlock> blocks = readBlocks(in, count);
    if (level == 0 && file.head.has_triangles) {
      const Section triangles = next();
      if (triangles.kind != kSectionTriangles) throw Damage("blocks without their ids");
      readTriangles(triangles.payload, blocks, file.head.triangle_count);
    }
    if (level == 0 && (file.head.has_normals || file.head.has_objects)) {
      const Section attributes = next();
      if (attributes.kind != kSectionAttributes) throw Damage("blocks without their attributes");
      readAttributes(file.head, attributes.payload, blocks);
    }
    addBlocks(file, level, std::move(blocks));
    ++chunks;
  }
}

}  // namespace

VoxelHead headOf(const Scene& scene, const VoxelizeOptions& options) {
  return {.lattice = options.lattice,
          .separation = options.separation,
          .has_triangles = options.with_triangles,
          .has_normals = options.attributes.normals,
          .has_objects = options.attributes.objects,
          .scene_hash = hashScene(scene),
          .triangle_count = scene.triangleCount(),
          .offset = scene.offset};
}

VoxelWriter::VoxelWriter(const std::filesystem::path& file, const VoxelHead& head)
    : output_(file), head_(head) {
  coarser_ = std::make_unique<CoarserBlocks>(
      [this](VoxelBlock&& block) { coarse_.front().blocks.push_back(std::move(block)); });
  coarse_.push_back({.lattice = {head.lattice.exponent + 1}, .blocks = {}});
  counts_.resize(1);
  put(writePrelude(kVoxelMagic, kVoxelVersion));
  put(writeSection(kSectionHead, headPayload(head)));
}

VoxelWriter::~VoxelWriter() = default;

void VoxelWriter::put(const Bytes& bytes) {
  output_.write(bytes.data(), bytes.size());
  checksum_.add(bytes);
}

void VoxelWriter::putChunk(size_t level, std::vector<VoxelBlock>& blocks) {
  if (blocks.empty()) return;
  VoxelLevelCounts& counts = counts_[level];
  for (const VoxelBlock& block : blocks) {
    counts.voxels += block.count();
    counts.bricks += block.bricks.size();
  }
  counts.blocks += blocks.size();
  const Bytes geometry = writeSection(kSectionBlocks, blocksPayload(uint32_t(level), blocks));
  counts.geometry_bytes += geometry.size();
  put(geometry);
  if (level == 0 && head_.has_triangles) {
    const Bytes triangles = writeSection(kSectionTriangles, trianglesPayload(blocks));
    counts.triangle_bytes += triangles.size();
    put(triangles);
  }
  if (level == 0 && (head_.has_normals || head_.has_objects)) {
    const Bytes attributes = writeSection(kSectionAttributes, attributesPayload(blocks));
    counts.attribute_bytes += attributes.size();
    put(attributes);
  }
  ++chunks_;
  blocks.clear();
}

void VoxelWriter::add(VoxelBlock&& block) {
  coarser_->add(block);
  pending_.push_back(std::move(block));
  if (pending_.size() == kBlocksAChunk) putChunk(0, pending_);
}

std::vector<VoxelLevelCounts> VoxelWriter::finish() {
  putChunk(0, pending_);
  coarser_->finish();
  // The finest level is not at hand any more; that it was a root is so small a case that one level too many
  // does not matter.
  while (!isRoot(coarse_.back())) coarse_.push_back(coarser(coarse_.back()));
  for (size_t i = 0; i < coarse_.size(); ++i) {
    counts_.emplace_back();
    std::vector<VoxelBlock> chunk;
    for (VoxelBlock& block : coarse_[i].blocks) {
      chunk.push_back(std::move(block));
      if (chunk.size() == kBlocksAChunk) putChunk(i + 1, chunk);
    }
    putChunk(i + 1, chunk);
  }
  ByteWriter end;
  end.number(chunks_);
  end.number(checksum_.value());
  put(writeSection(kSectionEnd, end.bytes()));
  output_.commit();
  return counts_;
}

VoxelFile parseVoxels(std::span<const uint8_t> bytes, const std::filesystem::path& file) {
  uint64_t at = 0;
  try {
    return parse(bytes, at);
  } catch (const Damage& damage) {
    throw Error(fmt::format("{}: byte {}: {}", file.string(), at, damage.what()));
  }
}

VoxelFile loadVoxels(const std::filesystem::path& file) {
  const FileBytes bytes = readFile(file);
  return parseVoxels({reinterpret_cast<const uint8_t*>(bytes.data.get()), bytes.size}, file);
}

bool isVoxelFile(const std::filesystem::path& file) {
  return beginsWith(file, kVoxelMagic) || lowerExtension(file) == ".slv";
}

void requireScene(const VoxelHead& head, uint64_t scene_hash, const std::filesystem::path& file) {
  if (head.scene_hash == scene_hash) return;
  throw Error(file.string() + ": has voxels of another scene, or of another state of it", kExitUsage);
}

}  // namespace sightline
