#include "core/draw/vulkan/gpu_culling.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "core/base/error.h"
#include "core/draw/vulkan/depth_pyramid.h"
#include "core/shared/pyramid.h"

namespace sightline {
namespace {

// Lists: opaque units in both passes, masked and blended ones; and all opaque units, and all blended ones.
constexpr uint32_t kEarly = 0, kLate = 1, kMasked = 2, kBlended = 3, kAll = 4, kAllBlended = 5, kLists = 6;
constexpr uint64_t kHeadBytes = uint64_t(kLists) * kHeadWords * 4;
constexpr uint32_t kUnitBoxVertices = 14;  // of vk_shaders/box.vert
constexpr uint64_t kUpdateBytes = 65536;   // of vkCmdUpdateBuffer

constexpr VkPipelineStageFlags kShaderStages =
    VK_PIPELINE_STAGE_ALL_GRAPHICS_BIT | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT;

uint32_t blocksOf(uint32_t units) {
  return (units + kCullBlock - 1) / kCullBlock;
}

void updateBuffer(const VulkanContext& context, VkCommandBuffer commands, const VulkanBuffer& to,
                  const void* data, uint64_t bytes) {
  for (uint64_t first = 0; first < bytes; first += kUpdateBytes) {
    context.api().vkCmdUpdateBuffer(commands, to.get(), first, std::min(kUpdateBytes, bytes - first),
                                    static_cast<const char*>(data) + first);
  }
}

/// Units that one list of the device holds.
uint64_t mostUnits(const VulkanLimits& limits) {
  return std::min<uint64_t>(limits.draws, uint64_t(limits.launch_groups) * kCullBlock);
}

}  // namespace

std::string whyNotCull(const VulkanDrawing& drawing, GpuMethod method) {
  const VulkanContext& context = drawing.context();
  if (std::string why = whyNotMethod(context.abilities(), method); !why.empty()) return why;
  const bool meshlets = method == GpuMethod::hizMeshlets;
  if (meshlets && drawing.mesh().hasSides()) {
    return "the scene has triangles that only their front shows, which meshlets do not know; take hiz";
  }
  const Drawables& drawables = drawing.mesh().drawables();
  const uint64_t most = mostUnits(context.limits());
  uint64_t units = drawables.list.size();
  if (meshlets && mostMeshletUnits(drawables) > most) {  // only then they are worth making to be counted
    units = meshletUnits(drawing.mesh().scene(), drawables).units.size();
  }
  if (units <= most) return "";
  return fmt::format("{} {} are more than the {} draws of one list; {}", units,
                     meshlets ? "meshlets" : "objects", most,
                     meshlets ? "take hiz" : "give a larger --split");
}

GpuCulling::GpuCulling(VulkanDrawing& drawing, GpuMethod method, const GpuCullingOptions& options)
    : drawing_(drawing), method_(method), faults_(options.faults) {
  const VulkanContext& context = drawing.context();
  if (const std::string why = whyNotCull(drawing, method); !why.empty()) {
    throw Error(fmt::format("{} ({}) cannot cull by {}: {}", context.info().id, context.info().name,
                            method == GpuMethod::boxes ? "boxes"
                            : method == GpuMethod::hiz ? "hiz"
                                                       : "hiz-meshlets",
                            why));
  }
  const Drawables& drawables = drawing.mesh().drawables();
  const bool meshlets = method == GpuMethod::hizMeshlets;
  units_ = meshlets ? meshletUnits(drawing.mesh().scene(), drawables) : drawableUnits(drawables);
  meshes_ = meshlets && options.mesh_shaders && context.has(VulkanFeature::kMeshShaders) &&
            unitCount() <= context.limits().mesh_groups;
  createBuffers();
}

GpuCulling::~GpuCulling() {
  try {
    drawing_.ring().drain();  // what runs reads the buffers
  } catch (const Error&) {    // a lost device runs nothing any more
  }
}

void GpuCulling::createBuffers() {
  const VulkanContext& context = drawing_.context();
  const uint64_t units = std::max<uint64_t>(units_.units.size(), 1);
  const auto make = [&](uint64_t bytes, const char* what) {
    return context.buffer(bytes, {what, "a larger --split"});
  };
  unit_buffer_ = make(units * sizeof(CullUnit), "boxes of what is drawn");
  states_ = make(units * 4, "states of what is drawn");
  block_counts_ = make(uint64_t(blocksOf(uint32_t(units))) * kLists * 4, "counts of what is drawn");
  draws_ = make(units * kDrawWords * 4, "lists of draws");
  heads_ = make(kHeadBytes, "lists of draws");
  candidates_ = make((drawing_.mesh().drawables().list.size() / 32 + 1) * 4, "candidates");
  const Range blended = range(AlphaKind::blended);
  order_ = make(std::max<uint64_t>(blended.count, 1) * 4, "order of glass");
  VulkanUpload upload(context);
  // Of the list of all opaque units, which stays; the others' are written in each frame.
  std::array<uint32_t, kLists * kHeadWords> heads{};
  const uint32_t all = range(AlphaKind::opaque).count;
  uint32_t* head = &heads[kAll * kHeadWords];
  head[0] = all;
  head[1] = std::min(all, kMeshletRow);
  head[2] = (all + kMeshletRow - 1) / kMeshletRow;
  head[3] = 1;
  heads[kAllBlended * kHeadWords] = range(AlphaKind::blended).count;
  upload.write(heads_, heads.data(), kHeadBytes);
  upload.write(unit_buffer_, units_.units.data(), units_.units.size() * sizeof(CullUnit));
  if (method_ == GpuMethod::hizMeshlets) {
    if (meshes_) {
      meshlets_ = make(std::max<uint64_t>(units_.words.size(), 1) * 4, "meshlets");
      upload.write(meshlets_, units_.words.data(), units_.words.size() * 4);
      // The units of a list, of both passes in turn; behind them all opaque ones.
      const Range opaque = range(AlphaKind::opaque);
      std::vector<uint32_t> listed(uint64_t(opaque.count) * 2 + 1);
      for (uint32_t i = 0; i < opaque.count; ++i) listed[opaque.count + i] = i;
      listed_ = make(listed.size() * 4, "lists of meshlets");
      upload.write(listed_, listed.data(), listed.size() * 4);
    } else {
      indices_ = make(std::max<uint64_t>(units_.indices.size(), 1) * 4, "triangles of meshlets");
      upload.write(indices_, units_.indices.data(), units_.indices.size() * 4);
    }
    upload.finish();
    units_.words = {};
    units_.indices = {};
  }
  upload.finish();
  launch_ = make(sizeof numbers_, "a method's launch");
  numbers_.units = unit_buffer_.address();
  numbers_.states = states_.address();
  numbers_.block_counts = block_counts_.address();
  numbers_.draws = draws_.address();
  numbers_.listed = listed_.address();
  numbers_.heads = heads_.address();
  numbers_.meshlets = meshlets_.address();
  numbers_.order = order_.address();
  numbers_.blocks = blocksOf(uint32_t(units));
  numbers_.shrink = float(faults_.shrink_pixels);
}

void GpuCulling::between(VkCommandBuffer commands) const {
  drawing_.barrier(
      commands, kShaderStages, VK_ACCESS_SHADER_WRITE_BIT, kShaderStages,
      VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_INDIRECT_COMMAND_READ_BIT);
}

void GpuCulling::fit(bool restricted) {
  const VulkanContext& context = drawing_.context();
  const uint64_t texels = levelStart(drawing_.camera().size.x, drawing_.camera().size.y,
                                     pyramidLevels(drawing_.camera().size.x, drawing_.camera().size.y));
  if (method_ != GpuMethod::boxes && texels > pyramid_texels_) {
    drawing_.ring().drain();
    pyramid_ = VulkanBuffer();
    pyramid_ = context.buffer(texels * 4, {"pyramid of depth", "a smaller resolution"});
    pyramid_texels_ = texels;
  }
  numbers_.pyramid = pyramid_.address();
  numbers_.candidates = restricted ? candidates_.address() : 0;
  const Kept kept{drawing_.targets(), restricted, pyramid_.address()};
  if (kept == kept_) return;
  kept_ = kept;
  key_ = drawing_.ring().newKey();
}

void GpuCulling::prepare(VkCommandBuffer commands, std::span<const uint32_t> new_candidates) {
  const VulkanContext& context = drawing_.context();
  drawing_.barrier(commands, kShaderStages | VK_PIPELINE_STAGE_TRANSFER_BIT,
                   VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
                   VK_ACCESS_TRANSFER_WRITE_BIT);
  updateBuffer(context, commands, launch_, &numbers_, sizeof numbers_);
  context.api().vkCmdFillBuffer(commands, heads_.get(), 0, kAll * kHeadWords * 4, 0);
  if (forget_) context.api().vkCmdFillBuffer(commands, states_.get(), 0, VK_WHOLE_SIZE, 0);
  if (!new_candidates.empty()) {
    updateBuffer(context, commands, candidates_, new_candidates.data(), new_candidates.size_bytes());
  }
  drawing_.barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT, kShaderStages,
                   VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
}

std::vector<uint32_t> GpuCulling::blendedOrder() const {
  const Range blended = range(AlphaKind::blended);
  const Camera& camera = drawing_.camera();
  const glm::dvec3 eye(xyz3(camera.eye)), forward(xyz3(camera.forward));
  std::vector<std::pair<double, uint32_t>> distances(blended.count);
  for (uint32_t i = 0; i < blended.count; ++i) {
    const CullUnit& unit = units_.units[blended.first + i];
    const glm::dvec3 centre = (glm::dvec3(unit.low) + glm::dvec3(unit.high)) * 0.5 - eye;
    distances[i] = {centre.x * forward.x + centre.y * forward.y + centre.z * forward.z, blended.first + i};
  }
  std::sort(distances.rbegin(), distances.rend());
  std::vector<uint32_t> order;
  for (const auto& [distance, unit] : distances) order.push_back(unit);
  return order;
}

void GpuCulling::test(VkCommandBuffer commands, Range range, uint32_t list, uint32_t test) {
  if (range.count == 0) return;
  drawing_.programs().run(commands, "cull_units.comp",
                          drawing_.push(address(), {range.first, range.count, list, test}),
                          blocksOf(range.count));
}

void GpuCulling::writeDraws(VkCommandBuffer commands, Range range, uint32_t list, uint32_t kind) {
  if (range.count == 0) return;
  drawing_.programs().run(commands, "write_draws.comp",
                          drawing_.push(address(), {range.first, range.count, list, kind}),
                          blocksOf(range.count));
}

void GpuCulling::drawOpaque(VkCommandBuffer commands, uint32_t list) {
  const Range opaque = range(AlphaKind::opaque);
  if (opaque.count == 0) return;
  const VulkanApi& api = drawing_.context().api();
  const uint64_t head = uint64_t(list) * kHeadWords * 4;
  if (meshes_) {
    drawing_.programs().bind(commands, DrawKind::meshlets,
                             drawing_.push(address(), {list, list == kAll ? opaque.count : 0, 0, 0}));
    api.vkCmdDrawMeshTasksIndirectEXT(commands, heads_.get(), head + 4, 1, 12);
    return;
  }
  if (drawing_.mesh().hasSides()) {
    drawing_.programs().bind(commands, DrawKind::masked, drawing_.push());
    api.vkCmdDrawIndirectCount(commands, draws_.get(), 0, heads_.get(), head, opaque.count, kDrawWords * 4);
    return;
  }
  drawing_.programs().bind(commands, DrawKind::opaque, drawing_.push());
  const VulkanBuffer& indices = method_ == GpuMethod::hizMeshlets ? indices_ : drawing_.mesh().indices();
  api.vkCmdBindIndexBuffer(commands, indices.get(), 0, VK_INDEX_TYPE_UINT32);
  api.vkCmdDrawIndexedIndirectCount(commands, draws_.get(), 0, heads_.get(), head, opaque.count,
                                    kDrawWords * 4);
}

void GpuCulling::drawAll(VkCommandBuffer commands) {
  if (meshes_) drawOpaque(commands, kAll);
}

uint32_t GpuCulling::opaqueKind() const {
  return meshes_ ? kDrawMeshlets : drawing_.mesh().hasSides() ? kDrawPlain : kDrawIndexed;
}

void GpuCulling::buildPyramid(VkCommandBuffer commands) {
  const uint32_t width = drawing_.camera().size.x, height = drawing_.camera().size.y;
  drawing_.barrier(commands, kShaderStages, 0, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT);
  drawing_.target().copy(drawing_.context(), commands, DrawTarget::Image::depth, pyramid_);
  drawing_.barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT, kShaderStages,
                   VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
  recordPyramid(drawing_, commands, pyramid_.address(), width, height, faults_.floor_levels);
}

void GpuCulling::testByBoxes(CommandRing::Entry& entry) {
  const Range all{0, unitCount()};
  test(entry.commands, all, kLate, kTestAsk);
  between(entry.commands);
  drawing_.ring().mark(entry, GpuPart::cull);
  drawing_.beginPass(entry);
  drawing_.programs().bind(entry.commands, DrawKind::unit_box, drawing_.push(address()));
  drawing_.context().api().vkCmdDraw(entry.commands, kUnitBoxVertices, all.count, 0, 0);
  drawing_.endPass(entry);
  between(entry.commands);
  drawing_.ring().mark(entry, GpuPart::query);
}

void GpuCulling::testLate(CommandRing::Entry& entry) {
  if (method_ == GpuMethod::boxes) {
    testByBoxes(entry);
  } else {
    buildPyramid(entry.commands);
    drawing_.ring().mark(entry, GpuPart::pyramid);
  }
  const uint32_t by = method_ == GpuMethod::boxes ? kTestBoxes : kTestPyramid;
  test(entry.commands, range(AlphaKind::opaque), kLate, by);
  test(entry.commands, range(AlphaKind::masked), kMasked, by);
  test(entry.commands, range(AlphaKind::blended), kBlended, by);
  between(entry.commands);
  writeDraws(entry.commands, range(AlphaKind::opaque), kLate, opaqueKind());
  writeDraws(entry.commands, range(AlphaKind::masked), kMasked, kDrawPlain);
  writeDraws(entry.commands, range(AlphaKind::blended), kBlended, kDrawOrdered);
  between(entry.commands);
  drawing_.ring().mark(entry, GpuPart::cull);
}

void GpuCulling::drawLate(CommandRing::Entry& entry) {
  const VulkanApi& api = drawing_.context().api();
  const Range masked = range(AlphaKind::masked), blended = range(AlphaKind::blended);
  drawing_.beginPass(entry);
  drawOpaque(entry.commands, kLate);
  constexpr uint32_t kStride = kDrawWords * 4;
  if (masked.count > 0) {
    drawing_.programs().bind(entry.commands, DrawKind::masked, drawing_.push());
    api.vkCmdDrawIndirectCount(entry.commands, draws_.get(), uint64_t(masked.first) * kStride, heads_.get(),
                               uint64_t(kMasked) * kHeadWords * 4, masked.count, kStride);
  }
  if (blended.count > 0) {
    drawing_.programs().bind(entry.commands, DrawKind::glass, drawing_.push());
    // Their number is known; but lavapipe (Mesa 25.0.7), told by no buffer, takes it from the last draw's
    // buffer.
    api.vkCmdDrawIndirectCount(entry.commands, draws_.get(), uint64_t(blended.first) * kStride, heads_.get(),
                               uint64_t(kAllBlended) * kHeadWords * 4, blended.count, kStride);
  }
  drawing_.endPass(entry);
  drawing_.ring().mark(entry, GpuPart::draw);
}

void GpuCulling::drawFrame(const Camera& camera) {
  drawAmong(camera, nullptr, false);
}

void GpuCulling::drawFrame(const Camera& camera, std::span<const uint32_t> candidates, bool changed) {
  drawAmong(camera, &candidates, changed);
}

void GpuCulling::drawAmong(const Camera& camera, const std::span<const uint32_t>* candidates, bool changed) {
  drawing_.beginFrame(camera);
  std::vector<uint32_t> bits;
  if (candidates != nullptr && (changed || !restricted_)) {
    bits.resize(drawing_.mesh().drawables().list.size() / 32 + 1);
    for (const uint32_t drawable : *candidates) bits[drawable / 32] |= 1u << drawable % 32;
  }
  restricted_ = candidates != nullptr;
  fit(restricted_);
  // What is forgotten, or new in this frame, no other frame has in common with it.
  const bool common = !forget_ && bits.empty();
  CommandRing::Entry& entry =
      drawing_.openKept(common ? key_ : drawing_.ring().newKey(), blendedOrder(), order_, kHeadBytes);
  if (!entry.recorded) record(entry, bits);
  forget_ = false;
  drawing_.submit(entry);
  drawing_.endFrame();
  last_ = &entry;
  last_serial_ = entry.serial;
}

void GpuCulling::record(CommandRing::Entry& entry, std::span<const uint32_t> new_candidates) {
  prepare(entry.commands, new_candidates);
  const Range opaque = range(AlphaKind::opaque);
  test(entry.commands, opaque, kEarly, kTestBefore);
  between(entry.commands);
  writeDraws(entry.commands, opaque, kEarly, opaqueKind());
  between(entry.commands);
  drawing_.ring().mark(entry, GpuPart::cull);
  drawing_.beginPass(entry);
  drawOpaque(entry.commands, kEarly);
  drawing_.endPass(entry);
  drawing_.ring().mark(entry, GpuPart::draw);
  testLate(entry);
  if (!faults_.no_second_pass) drawLate(entry);
  drawing_.barrier(entry.commands, kShaderStages, VK_ACCESS_SHADER_WRITE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
                   VK_ACCESS_TRANSFER_READ_BIT);
  const VkBufferCopy all{0, 0, kHeadBytes};
  drawing_.context().api().vkCmdCopyBuffer(entry.commands, heads_.get(), entry.results.get(), 1, &all);
  drawing_.barrier(entry.commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                   VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
}

FrameCounts GpuCulling::counts() {
  FrameCounts counts;
  if (last_ == nullptr || last_->serial != last_serial_) return counts;
  drawing_.ring().wait(*last_);
  const auto* heads = static_cast<const uint32_t*>(last_->results.mapped());
  for (uint32_t list = kEarly; list <= kBlended; ++list) {
    counts.draws += heads[list * kHeadWords];
    counts.triangles += heads[list * kHeadWords + kHeadTriangles];
  }
  counts.objects = counts.draws;
  counts.submits = 1;
  return counts;
}

std::vector<uint32_t> GpuCulling::readSeen() {
  const VulkanContext& context = drawing_.context();
  std::vector<uint32_t> states(unitCount());
  const VulkanBuffer buffer = context.buffer(4 * states.size(), "states", VulkanMemory::kReadback);
  drawing_.ring().drain();
  VulkanCommands commands(context, context.queue(), context.queueFamily());
  commands.copy(states_, buffer, 4 * states.size());
  commands.finish();
  std::memcpy(states.data(), buffer.mapped(), 4 * states.size());
  for (uint32_t& state : states) state = (state & kUnitSeen) != 0 ? 1 : 0;
  return states;
}

}  // namespace sightline
