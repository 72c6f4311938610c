#include "core/draw/vulkan/command_ring.h"

#include <algorithm>

namespace sightline {
namespace {

constexpr size_t kFirstEntries = 64;
constexpr uint32_t kTimes = 16;
constexpr size_t kKeptFrames = 16;

VulkanHandle<VkQueryPool> queryPool(const VulkanContext& context, VkQueryType type, uint32_t count) {
  auto info = vkStruct<VkQueryPoolCreateInfo>(VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO);
  info.queryType = type;
  info.queryCount = count;
  VkQueryPool pool = VK_NULL_HANDLE;
  checkVk(context.api().vkCreateQueryPool(context.device(), &info, nullptr, &pool), "vkCreateQueryPool");
  return {context, pool, [](const VulkanContext& c, VkQueryPool handle) {
            c.api().vkDestroyQueryPool(c.device(), handle, nullptr);
          }};
}

}  // namespace

CommandRing::CommandRing(const VulkanContext& context, DrawClock clock, SubmitChain chain)
    : context_(context), clock_(std::move(clock)), chain_(chain) {
  for (size_t i = 0; i < kFirstEntries; ++i) entries_.push_back(make());
}

CommandRing::~CommandRing() {
  // Whatever it says: a lost device runs nothing any more.
  for (const auto& entry : entries_) {
    if (entry->running) {
      context_.api().vkWaitForFences(context_.device(), 1, entry->fence.address(), VK_TRUE, UINT64_MAX);
    }
  }
}

std::unique_ptr<CommandRing::Entry> CommandRing::make() const {
  const VulkanApi& api = context_.api();
  auto entry = std::make_unique<Entry>();
  auto pool_info = vkStruct<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
  pool_info.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
  pool_info.queueFamilyIndex = context_.queueFamily();
  VkCommandPool pool = VK_NULL_HANDLE;
  checkVk(api.vkCreateCommandPool(context_.device(), &pool_info, nullptr, &pool), "vkCreateCommandPool");
  entry->pool = {context_, pool, [](const VulkanContext& c, VkCommandPool handle) {
                   c.api().vkDestroyCommandPool(c.device(), handle, nullptr);
                 }};
  auto buffer_info = vkStruct<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  buffer_info.commandPool = pool;
  buffer_info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  buffer_info.commandBufferCount = 1;
  checkVk(api.vkAllocateCommandBuffers(context_.device(), &buffer_info, &entry->commands),
          "vkAllocateCommandBuffers");
  const auto fence_info = vkStruct<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
  VkFence fence = VK_NULL_HANDLE;
  checkVk(api.vkCreateFence(context_.device(), &fence_info, nullptr, &fence), "vkCreateFence");
  entry->fence = {context_, fence, [](const VulkanContext& c, VkFence handle) {
                    c.api().vkDestroyFence(c.device(), handle, nullptr);
                  }};
  if (chain_ == SubmitChain::semaphores) {
    const auto info = vkStruct<VkSemaphoreCreateInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO);
    VkSemaphore done = VK_NULL_HANDLE;
    checkVk(api.vkCreateSemaphore(context_.device(), &info, nullptr, &done), "vkCreateSemaphore");
    entry->done = {context_, done, [](const VulkanContext& c, VkSemaphore handle) {
                     c.api().vkDestroySemaphore(c.device(), handle, nullptr);
                   }};
  }
  if (context_.hasTimestamps()) entry->times = queryPool(context_, VK_QUERY_TYPE_TIMESTAMP, kTimes);
  return entry;
}

void CommandRing::reserveQueries(Entry& entry, uint32_t queries) const {
  if (queries > entry.query_capacity) {
    entry.query_capacity = std::max(queries, 2 * entry.query_capacity);
    entry.queries = VulkanHandle<VkQueryPool>();
    entry.queries = queryPool(context_, VK_QUERY_TYPE_OCCLUSION, entry.query_capacity);
  }
  if (queries > 0) context_.api().vkResetQueryPool(context_.device(), entry.queries.get(), 0, queries);
}

void CommandRing::beginFrame(uint64_t frame) {
  frame_ = frame;
  cpu_ = {};
  FrameLog log;
  if (frames_.size() >= kKeptFrames) {
    log = std::move(frames_.front());  // for its memory
    frames_.pop_front();
    log.gpu.clear();
    log.cpu.clear();
  }
  log.frame = frame;
  frames_.push_back(std::move(log));
}

double CommandRing::spent(CpuWork work, double begin) {
  if (!clock_) return 0;
  const double end = clock_();
  if (!frames_.empty()) frames_.back().cpu.push_back({work, begin, end});
  return end - begin;
}

bool CommandRing::hasRun(const Entry& entry) const {
  return !entry.running ||
         context_.api().vkGetFenceStatus(context_.device(), entry.fence.get()) == VK_SUCCESS;
}

CommandRing::Entry& CommandRing::take() {
  if (!hasRun(*entries_.front())) entries_.push_front(make());
  Entry& entry = *entries_.front();
  harvest(entry);
  std::rotate(entries_.begin(), entries_.begin() + 1, entries_.end());
  return entry;
}

void CommandRing::start(Entry& entry, double opened) {
  entry.frame = frame_;
  entry.serial = ++serial_;
  entry.opened = opened;
  if (entry.times.get() != VK_NULL_HANDLE) {
    context_.api().vkResetQueryPool(context_.device(), entry.times.get(), 0, kTimes);
  }
}

void CommandRing::record(Entry& entry, uint32_t queries, uint64_t box_bytes, uint64_t result_bytes,
                         bool once) {
  const VulkanApi& api = context_.api();
  reserveQueries(entry, queries);
  if (entry.boxes.bytes() < box_bytes) {
    entry.boxes = VulkanBuffer();
    entry.boxes = context_.buffer(2 * box_bytes, "boxes of queries", VulkanMemory::kShared);
  }
  if (entry.results.bytes() < result_bytes) {
    entry.results = VulkanBuffer();
    entry.results = context_.buffer(result_bytes, "counts of a frame", VulkanMemory::kReadback);
  }
  entry.answers = std::make_shared<Answers>(queries, int8_t(-1));
  entry.parts.clear();
  entry.recorded = false;
  ++recordings_;
  checkVk(api.vkResetCommandPool(context_.device(), entry.pool.get(), 0), "vkResetCommandPool");
  auto info = vkStruct<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  info.flags = once ? VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT : 0;
  checkVk(api.vkBeginCommandBuffer(entry.commands, &info), "vkBeginCommandBuffer");
  if (entry.times.get() == VK_NULL_HANDLE) return;
  // After all that was submitted before: times of submits do not overlap.
  api.vkCmdWriteTimestamp(entry.commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, entry.times.get(), 0);
}

CommandRing::Entry& CommandRing::open(uint32_t queries, uint64_t box_bytes, uint64_t result_bytes) {
  const double opened = now();
  Entry& entry = take();
  entry.key = 0;
  start(entry, opened);
  record(entry, queries, box_bytes, result_bytes, true);
  return entry;
}

CommandRing::Entry& CommandRing::openKept(uint64_t key, uint64_t box_bytes, uint64_t result_bytes) {
  const double opened = now();
  const auto kept = std::ranges::find_if(
      entries_, [&](const std::unique_ptr<Entry>& entry) { return entry->key == key && hasRun(*entry); });
  if (kept != entries_.end()) {
    Entry& entry = **kept;
    harvest(entry);
    std::rotate(kept, kept + 1, entries_.end());
    start(entry, opened);
    entry.recorded = true;
    return entry;
  }
  Entry& entry = take();
  entry.key = key;
  start(entry, opened);
  record(entry, 0, box_bytes, result_bytes, false);
  return entry;
}

void CommandRing::mark(Entry& entry, GpuPart part) {
  if (entry.times.get() == VK_NULL_HANDLE || entry.parts.size() + 1 >= kTimes) return;
  entry.parts.push_back(part);
  context_.api().vkCmdWriteTimestamp(entry.commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, entry.times.get(),
                                     uint32_t(entry.parts.size()));
}

void CommandRing::submit(Entry& entry) {
  const VulkanApi& api = context_.api();
  if (!entry.recorded) checkVk(api.vkEndCommandBuffer(entry.commands), "vkEndCommandBuffer");
  cpu_.record += spent(CpuWork::record, entry.opened);
  const double recorded = now();
  checkVk(api.vkResetFences(context_.device(), 1, entry.fence.address()), "vkResetFences");
  auto info = vkStruct<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
  info.commandBufferCount = 1;
  info.pCommandBuffers = &entry.commands;
  // Waited for by the submit after it, which is always the ring's next: signalled once, waited for once.
  const VkPipelineStageFlags all = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
  if (chain_ == SubmitChain::semaphores) {
    info.signalSemaphoreCount = 1;
    info.pSignalSemaphores = entry.done.address();
    info.waitSemaphoreCount = last_done_ != VK_NULL_HANDLE ? 1 : 0;
    info.pWaitSemaphores = &last_done_;
    info.pWaitDstStageMask = &all;
  }
  checkVk(api.vkQueueSubmit(context_.queue(), 1, &info, entry.fence.get()), "vkQueueSubmit");
  entry.running = true;
  last_done_ = entry.done.get();
  cpu_.submit += spent(CpuWork::submit, recorded);
}

bool CommandRing::arrived(Entry& entry, uint64_t serial, Answers& answers, uint32_t query) {
  if (answers[query] >= 0 || entry.serial != serial) return true;  // who was taken anew has left its answers
  uint32_t samples = 0;
  const double start = now();  // some drivers wait here, though asked not to
  const VkResult code = context_.api().vkGetQueryPoolResults(context_.device(), entry.queries.get(), query, 1,
                                                             sizeof samples, &samples, sizeof samples, 0);
  if (code == VK_SUCCESS) {
    answers[query] = samples > 0;
    takeAnswers(entry, answers, query + 1);
  }
  cpu_.look += spent(CpuWork::wait, start);
  if (code == VK_NOT_READY) return false;
  checkVk(code, "vkGetQueryPoolResults");
  return true;
}

void CommandRing::takeAnswers(Entry& entry, Answers& answers, uint32_t first) {
  const auto count = uint32_t(answers.size()) - first;
  if (count == 0) return;
  taken_.resize(count);
  const VkResult code = context_.api().vkGetQueryPoolResults(
      context_.device(), entry.queries.get(), first, count, count * sizeof taken_[0], taken_.data(),
      sizeof taken_[0], VK_QUERY_RESULT_WITH_AVAILABILITY_BIT);
  if (code != VK_NOT_READY) checkVk(code, "vkGetQueryPoolResults");
  for (uint32_t i = 0; i < count; ++i) {
    const auto [samples, there] = taken_[i];
    if (there != 0) answers[first + i] = samples > 0;
  }
}

bool CommandRing::answer(Entry& entry, uint64_t serial, Answers& answers, uint32_t query) {
  if (!arrived(entry, serial, answers, query)) {
    const double start = now();
    ++waits_;
    uint32_t samples = 0;
    checkVk(
        context_.api().vkGetQueryPoolResults(context_.device(), entry.queries.get(), query, 1, sizeof samples,
                                             &samples, sizeof samples, VK_QUERY_RESULT_WAIT_BIT),
        "vkGetQueryPoolResults");
    answers[query] = samples > 0;
    cpu_.wait += spent(CpuWork::wait, start);
    takeAnswers(entry, answers, query + 1);
  }
  return answers[query] > 0;
}

void CommandRing::wait(Entry& entry) {
  if (!entry.running) return;
  const double start = now();
  checkVk(context_.api().vkWaitForFences(context_.device(), 1, entry.fence.address(), VK_TRUE, UINT64_MAX),
          "vkWaitForFences");
  cpu_.wait += spent(CpuWork::wait, start);
  harvest(entry);
}

void CommandRing::drain() {
  for (const auto& entry : entries_) wait(*entry);
}

void CommandRing::harvest(Entry& entry) {
  if (!entry.running) return;
  entry.running = false;
  const VulkanApi& api = context_.api();
  if (const auto count = uint32_t(entry.answers->size()); count > 0) {
    std::vector<uint32_t> samples(count);
    checkVk(api.vkGetQueryPoolResults(context_.device(), entry.queries.get(), 0, count, count * 4,
                                      samples.data(), 4, 0),
            "vkGetQueryPoolResults");
    for (uint32_t i = 0; i < count; ++i) (*entry.answers)[i] = samples[i] > 0;
  }
  if (entry.parts.empty()) return;
  std::array<uint64_t, kTimes> ticks{};
  const auto count = uint32_t(entry.parts.size() + 1);
  checkVk(api.vkGetQueryPoolResults(context_.device(), entry.times.get(), 0, count, count * 8, ticks.data(),
                                    8, VK_QUERY_RESULT_64_BIT),
          "vkGetQueryPoolResults");
  const auto log = std::ranges::find(frames_, entry.frame, &FrameLog::frame);
  if (log == frames_.end()) return;
  for (uint32_t i = 1; i < count; ++i) log->gpu.push_back({entry.parts[i - 1], ticks[i - 1], ticks[i]});
}

CommandRing::FrameLog* CommandRing::finished(uint64_t frame) {
  for (const auto& entry : entries_) {
    if (entry->frame == frame) wait(*entry);
  }
  const auto log = std::ranges::find(frames_, frame, &FrameLog::frame);
  if (log == frames_.end() || log->gpu.empty()) return log == frames_.end() ? nullptr : &*log;
  // Submits are looked at in the order in which they end, mostly.
  std::ranges::sort(log->gpu, {}, [](const GpuSpan& span) { return std::pair(span.begin, span.end); });
  return &*log;
}

GpuTimes CommandRing::gpuTimes(uint64_t frame) {
  GpuTimes times;
  const FrameLog* log = finished(frame);
  if (log == nullptr || log->gpu.empty()) return times;
  const double ms = context_.limits().timestamp_ns * 1e-6;
  uint64_t last = 0;
  for (const GpuSpan& span : log->gpu) {
    times.part[size_t(span.part)] += double(span.end - span.begin) * ms;
    last = std::max(last, span.end);
  }
  times.frame = double(last - log->gpu.front().begin) * ms;
  double parts = 0;
  for (const double part : times.part) parts += part;
  times.rest = std::max(0.0, times.frame - parts);
  return times;
}

FrameSpans CommandRing::spans(uint64_t frame) {
  FrameSpans spans;
  const FrameLog* log = finished(frame);
  if (log == nullptr) return spans;
  spans.cpu = log->cpu;
  const double ms = context_.limits().timestamp_ns * 1e-6;
  for (const GpuSpan& span : log->gpu) {
    const uint64_t first = log->gpu.front().begin;
    spans.gpu.push_back({span.part, double(span.begin - first) * ms, double(span.end - first) * ms});
  }
  return spans;
}

}  // namespace sightline
