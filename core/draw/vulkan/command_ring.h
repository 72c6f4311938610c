#pragma once
#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "core/vulkan/vulkan_context.h"

namespace sightline {

/// What a GPU's time in a frame goes to.
enum class GpuPart { draw, query, pyramid, cull };
inline constexpr size_t kGpuParts = 4;

/// A frame's time on the GPU, in milliseconds; all 0 where the device knows no time.
struct GpuTimes {
  std::array<double, kGpuParts> part{};  ///< by GpuPart
  double rest = 0;                       ///< between submits, and what belongs to no part
  double frame = 0;                      ///< from the first command to the last
};

/// The processor's time in a frame in milliseconds, without what the method itself takes; all 0 without a
/// clock.
struct CpuTimes {
  double record = 0, submit = 0;
  double look = 0;  ///< to find out whether answers have arrived
  double wait = 0;  ///< for answers that had not
};

/// What the processor does with commands.
enum class CpuWork { record, submit, wait };

/// When, in milliseconds.
template <typename Part>
struct TimeSpan {
  Part part;
  double begin = 0, end = 0;
};

/// What happened when in a frame, in order. The processor's times are the clock's; the GPU's count from its
/// first command.
struct FrameSpans {
  std::vector<TimeSpan<CpuWork>> cpu;  ///< empty without a clock
  std::vector<TimeSpan<GpuPart>> gpu;  ///< empty where the device knows no time
};

/// What makes a submit wait for the one before it. Submits of one queue start in their order in any case.
enum class SubmitChain {
  barriers,    ///< of memory, in the commands
  semaphores,  ///< one a submit besides, as the thesis has it (3.1.3)
};

/// Milliseconds from whenever; empty: no time is measured.
using DrawClock = std::function<double()>;

/// Command buffers that are used in turn, each with what a submit takes: a fence, times, queries, boxes. The
/// oldest is taken if it has run, else there will be one more, so that nobody waits for one.
class CommandRing {
 public:
  /// Answers of a submit's queries: 1, 0, or -1 while unknown.
  using Answers = std::vector<int8_t>;

  struct Entry {
    VulkanHandle<VkCommandPool> pool;
    VulkanHandle<VkFence> fence;
    VulkanHandle<VkSemaphore> done;  ///< with SubmitChain::semaphores
    VulkanHandle<VkQueryPool> times, queries;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    VulkanBuffer boxes;    ///< kShared
    VulkanBuffer results;  ///< kReadback
    uint32_t query_capacity = 0;
    std::shared_ptr<Answers> answers;
    std::vector<GpuPart> parts;  ///< that end at the times after the first
    uint64_t frame = 0, serial = 0;
    bool running = false;
    double opened = 0;
    uint64_t key = 0;       ///< of what is recorded: not 0 where it may be submitted again
    bool recorded = false;  ///< has been, in an earlier frame: nothing is to be recorded
  };

  CommandRing(const VulkanContext& context, DrawClock clock, SubmitChain chain = SubmitChain::barriers);
  CommandRing(const CommandRing&) = delete;
  CommandRing& operator=(const CommandRing&) = delete;
  ~CommandRing();

  void beginFrame(uint64_t frame);
  /// An entry that records, with room for so many queries and bytes of boxes and results.
  Entry& open(uint32_t queries, uint64_t box_bytes, uint64_t result_bytes);
  /// The same for commands that frames have in common: those that were recorded under the key (newKey) are
  /// there again (Entry::recorded), if they have run, and are to be submitted as they are.
  Entry& openKept(uint64_t key, uint64_t box_bytes, uint64_t result_bytes);
  uint64_t newKey() { return ++keys_; }
  /// What was recorded since the last mark, or the start, belongs to the part.
  void mark(Entry& entry, GpuPart part);
  void submit(Entry& entry);

  /// Whether the answer of an entry's query is there; never waits. serial: of the submit. With one all the
  /// submit's answers that are there are taken, so that the driver is not asked for each.
  bool arrived(Entry& entry, uint64_t serial, Answers& answers, uint32_t query);
  /// Waits for it.
  bool answer(Entry& entry, uint64_t serial, Answers& answers, uint32_t query);
  void wait(Entry& entry);
  /// Waits until all has run.
  void drain();

  /// Of one of the last few frames; waits until it has run.
  GpuTimes gpuTimes(uint64_t frame);
  /// Likewise.
  FrameSpans spans(uint64_t frame);
  /// Since beginFrame.
  const CpuTimes& cpuTimes() const { return cpu_; }
  size_t size() const { return entries_.size(); }
  uint64_t waits() const { return waits_; }            ///< for answers, since it was made
  uint64_t recordings() const { return recordings_; }  ///< of command buffers, likewise

 private:
  struct GpuSpan {
    GpuPart part;
    uint64_t begin, end;  ///< ticks
  };
  /// A frame's times.
  struct FrameLog {
    uint64_t frame = 0;
    std::vector<GpuSpan> gpu;
    std::vector<TimeSpan<CpuWork>> cpu;
  };

  std::unique_ptr<Entry> make() const;
  /// To be recorded anew; the oldest that has run, or a new one.
  Entry& take();
  /// Whether it has run, as far as is known without waiting.
  bool hasRun(const Entry& entry) const;
  void start(Entry& entry, double opened);
  void record(Entry& entry, uint32_t queries, uint64_t box_bytes, uint64_t result_bytes, bool once);
  double now() const { return clock_ ? clock_() : 0; }
  /// Takes the answers from this one on that are there.
  void takeAnswers(Entry& entry, Answers& answers, uint32_t first);
  void reserveQueries(Entry& entry, uint32_t queries) const;
  /// Waits for what the entry's frame has under way.
  FrameLog* finished(uint64_t frame);
  /// What the processor did since `begin`; returns how long it took.
  double spent(CpuWork work, double begin);
  /// Keeps what the entry's queries and times say.
  void harvest(Entry& entry);

  const VulkanContext& context_;
  DrawClock clock_;
  SubmitChain chain_;
  VkSemaphore last_done_ = VK_NULL_HANDLE;      ///< of the last submit
  std::deque<std::unique_ptr<Entry>> entries_;  ///< the oldest first
  std::deque<FrameLog> frames_;                 ///< the last few
  std::vector<std::array<uint32_t, 2>> taken_;  ///< samples, and whether they are there; kept for its memory
  CpuTimes cpu_;
  uint64_t frame_ = 0, serial_ = 0, waits_ = 0, keys_ = 0, recordings_ = 0;
};

}  // namespace sightline
