#include "core/draw/vulkan/vulkan_query_backend.h"

#include <algorithm>
#include <stdexcept>

namespace sightline {
namespace {

constexpr uint32_t kBoxVertices = 14;  // of vk_shaders/box.vert

}  // namespace

void VulkanQueryBackend::beginFrame(const Camera& camera) {
  drawing_.beginFrame(camera);
  while (!submitted_.empty() && submitted_.front().frame + 1 < drawing_.frame()) submitted_.pop_front();
}

QueryId VulkanQueryBackend::submit(std::span<const uint32_t> draws, std::span<const OcclusionQuery> queries) {
  uint64_t boxes = 0;
  for (const OcclusionQuery& query : queries) boxes += query.boxes.size();
  CommandRing::Entry& entry = drawing_.open(uint32_t(queries.size()), boxes * sizeof(AxisBox));
  const VulkanApi& api = drawing_.context().api();
  drawing_.beginPass(entry);
  std::optional<AlphaKind> bound;
  for (const uint32_t drawable : draws) {
    drawing_.draw(entry.commands, drawing_.mesh().run(drawable), drawable, bound);
  }
  if (!draws.empty()) drawing_.ring().mark(entry, GpuPart::draw);
  if (!queries.empty()) {
    static_assert(sizeof(AxisBox) == 24, "six floats, as box.vert reads them");
    auto* out = static_cast<AxisBox*>(entry.boxes.mapped());
    drawing_.programs().bind(entry.commands, DrawKind::query_box, drawing_.push(entry.boxes.address()));
    uint32_t first = 0;
    for (uint32_t i = 0; i < queries.size(); ++i) {
      const auto count = uint32_t(queries[i].boxes.size());
      std::copy(queries[i].boxes.begin(), queries[i].boxes.end(), out + first);
      api.vkCmdBeginQuery(entry.commands, entry.queries.get(), i, 0);
      api.vkCmdDraw(entry.commands, kBoxVertices, count, 0, first);
      api.vkCmdEndQuery(entry.commands, entry.queries.get(), i);
      first += count;
    }
    drawing_.ring().mark(entry, GpuPart::query);
  }
  drawing_.endPass(entry);
  drawing_.submit(entry);
  const QueryId id = next_;
  if (!queries.empty()) {
    submitted_.push_back({id, drawing_.frame(), entry.serial, &entry, entry.answers});
    next_ += queries.size();
  }
  return id;
}

void VulkanQueryBackend::submitList(uint32_t list) {
  CommandRing::Entry& entry = drawing_.open();
  drawing_.beginPass(entry);
  std::optional<AlphaKind> bound;
  for (const SlotRun& run : drawing_.mesh().listRuns(list)) {
    drawing_.draw(entry.commands, run, kSomeDrawable, bound);
  }
  drawing_.endPass(entry);
  drawing_.ring().mark(entry, GpuPart::draw);
  drawing_.submit(entry);
}

VulkanQueryBackend::Submitted& VulkanQueryBackend::of(QueryId query) {
  const auto after = std::upper_bound(submitted_.begin(), submitted_.end(), query,
                                      [](QueryId id, const Submitted& s) { return id < s.first; });
  if (query >= next_ || after == submitted_.begin()) throw std::out_of_range("a query of no recent frame");
  return *(after - 1);
}

bool VulkanQueryBackend::arrived(QueryId query) {
  Submitted& its = of(query);
  return drawing_.ring().arrived(*its.entry, its.serial, *its.answers, uint32_t(query - its.first));
}

bool VulkanQueryBackend::visible(QueryId query) {
  Submitted& its = of(query);
  return drawing_.ring().answer(*its.entry, its.serial, *its.answers, uint32_t(query - its.first));
}

}  // namespace sightline
