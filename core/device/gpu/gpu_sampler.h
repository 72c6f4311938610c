#pragma once
#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "core/device/device.h"
#include "core/device/gpu/gpu_set.h"
#include "core/sampling/random_segment.h"
#include "core/sampling/stage_rays.h"
#include "core/scene/scene.h"

namespace sightline {

/// The stages of GVS++ on a GPU, with scene, set and list in its memory, over an API of this shape:
///
///   typename Buffer                            movable; empty by default: bytes() == 0
///   DeviceInfo info()
///   bool fits(bytes), uint64_t allocatedBytes()
///   Buffer buffer(bytes, what)                 throws Error that names what does not fit
///   void release(Buffer&)                      empties it once no command needs it
///   void write(Buffer, data, bytes)            in turn with the commands; data may go at once
///   void read(Buffer, target, bytes)           waits
///   void fill(Buffer, word, bytes), copy(from, to, bytes)
///   StageLaunch& launch()                      of the next run
///   void bind(StageBuffer, Buffer)             for the runs that follow
///   void prepare(span<const GpuStage>)         compiles these tracing stages and all others, if that is to
///   do void run(GpuStage, count)                  over so many rays or work items, after all before it array
///   takeCounters()                       waits; kCounterWords words, which are 0 again then
///
/// place_of is bound by the API, as are scene and counters.
template <typename Api>
class GpuSampler : public Device {
 public:
  /// arguments: of the API's constructor.
  template <typename... Arguments>
  explicit GpuSampler(const Scene& scene, const DeviceOptions& options, const Arguments&... arguments)
      : api_(arguments...),
        has_glass_(featuresOf(scene.surfaces).glass),
        triangle_count_(scene.triangleCount()),
        set_(api_, triangle_count_, wantsHash(options)) {
    reserve(StageBuffer::faces, 6 * sizeof(Face), "faces of the view cell");
    reserveEntries(1u << 16);
  }

  DeviceInfo info() const override { return api_.info(); }

  void prepare(bool explores, const StageParams& params) override {
    const GpuStage border = isGvs(params) ? GpuStage::kTraceGvsBorder : GpuStage::kTraceBorder;
    const GpuStage stages[] = {GpuStage::kTraceRandom, border, GpuStage::kTraceReverse};
    api_.prepare(std::span(stages).first(explores ? 3 : 1));
  }

  void beginCell(std::span<const Face> faces, const StageParams& params) override {
    api_.write(at(StageBuffer::faces), faces.data(), faces.size_bytes());
    launch().params = params;
    launch().items_before = launch().waiting = 0;
    set_.clear();
    segments_.clear();
    size_ = fresh_ = 0;
    rays_ = 0;
  }

  void traceRandom(const RandomSegment& segment) override {
    segments_.push_back(segment);
    launch().segment = segment;
    launch().shifts = launch().params.shifts;
    traceUntilItFits([&] { api_.run(GpuStage::kTraceRandom, slotCount(segment)); });
  }

  BorderBatch traceBorder(uint32_t first, uint32_t most_rays, bool listing) override {
    const uint32_t total = beginBorderBatch(first, most_rays);
    const uint32_t words = (total + 31) / 32;
    const bool gvs = isGvs(launch().params), thin = listing && !gvs && launch().params.method.y > 1;
    const StageBuffer listed = thin ? StageBuffer::kept_bits : StageBuffer::bits;
    reserve(StageBuffer::border_hits, uint64_t(total) * 4, "hits of border rays");
    reserve(StageBuffer::bits, uint64_t(words) * 4, "bits of discontinuities");
    if (thin) reserve(StageBuffer::kept_bits, uint64_t(words) * 4, "bits of discontinuities");
    api_.fill(at(StageBuffer::bits), 0, uint64_t(words) * 4);
    if (gvs) api_.fill(at(StageBuffer::border_hits), kNotTraced, uint64_t(total) * 4);
    const uint32_t met = traceUntilItFits([&] {
      traceBorderRays(total);
      if (thin) api_.run(GpuStage::kThinDiscontinuities, words);
      if (listing) countBits(at(listed), words, at(StageBuffer::block_counts), kListCounter);
    });
    if (!listing) return {launch().border_count, 0};
    if (met > 0) {
      writeIndices(at(listed), words, at(StageBuffer::block_counts), met, at(StageBuffer::indices),
                   "indices of discontinuities");
      growList(StageBuffer::discontinuities, uint64_t(launch().waiting) * sizeof(Discontinuity),
               (uint64_t(launch().waiting) + met) * sizeof(Discontinuity), ~uint64_t(0),
               "list of discontinuities");
      api_.run(GpuStage::kAppendDiscontinuities, met);
      launch().waiting += met;
    }
    return {launch().border_count, met};
  }

  void traceReverse(uint32_t first, uint32_t count) override {
    launch().reverse_first = first;
    reserve(StageBuffer::reverse_items, uint64_t(count) * sizeof(ReverseItem), "reverse samples");
    api_.run(GpuStage::kReverseItems, count);
    traceUntilItFits(
        [&] { api_.run(GpuStage::kTraceReverse, uint64_t(count) * reverseRayCount(launch().params)); });
  }

  void dropDiscontinuities() override {
    launch().items_before += launch().waiting;
    launch().waiting = 0;
  }

  uint32_t collect(uint32_t stage) override {
    const uint32_t found = std::exchange(fresh_, 0u);
    if (found > 0) {
      writeIndices(set_.fresh(), set_.freshWords(), fresh_counts_, found, new_ids_, "list of new triangles");
      reserveEntries(size_ + found);
      put(StageBuffer::segments, segments_.data(), segments_.size(), "random segments");
      launch().segment_count = static_cast<uint32_t>(segments_.size());
      launch().stage = stage;
      launch().list_end = size_;
      api_.run(GpuStage::kAppendEntries, found);
      size_ += found;
      set_.fit(size_);
    }
    segments_.clear();
    return found;
  }

  void insertContained(std::span<const uint32_t> triangles) override {
    if (triangles.empty()) return;
    const auto count = static_cast<uint32_t>(triangles.size());
    reserveEntries(size_ + count);
    set_.fit(size_ + count);
    enlarge(new_ids_, triangles.size_bytes(), "list of contained triangles");
    api_.write(new_ids_, triangles.data(), triangles.size_bytes());
    api_.bind(StageBuffer::indices, new_ids_);
    launch().list_end = size_;
    traceUntilItFits([&] { api_.run(GpuStage::kInsertContained, count); });
    size_ += count;
  }

  uint64_t countMissing(const RandomSegment& segment, uvec4 shifts) override {
    launch().segment = segment;
    launch().shifts = shifts;
    api_.run(GpuStage::kCountMissing, slotCount(segment));
    const auto counters = api_.takeCounters();
    bookRays(counters);
    return counters[kMissingCounter];
  }

  DeviceCounters counters() override { return {rays_, api_.allocatedBytes(), set_.capacity() > 0}; }

  std::vector<PvsEntry> readPvs() override {
    std::vector<PvsEntry> list(size_);
    api_.read(at(StageBuffer::entries), list.data(), list.size() * sizeof(PvsEntry));
    return list;
  }

  void traceRays(std::span<const Ray> rays, std::span<Hit> hits) override {
    const size_t chunk = std::min(kRayChunk, rays.size());
    reserve(StageBuffer::hits, chunk * sizeof(Hit), "hits");
    for (size_t first = 0; first < rays.size(); first += chunk) {
      const size_t count = std::min(chunk, rays.size() - first);
      put(StageBuffer::rays, &rays[first], count, "rays");
      api_.run(GpuStage::kTraceRays, count);
      api_.read(at(StageBuffer::hits), &hits[first], count * sizeof(Hit));
    }
  }

  bool hasGlass() const override { return has_glass_; }

  std::vector<SeenThrough> traceGlass(std::span<const Ray> rays, std::span<const Hit> hits) override {
    std::vector<SeenThrough> seen;
    for (size_t first = 0; has_glass_ && first < rays.size(); first += kRayChunk) {
      const size_t count = std::min(kRayChunk, rays.size() - first);
      put(StageBuffer::rays, &rays[first], count, "rays");
      put(StageBuffer::hits, &hits[first], count, "hits");
      const size_t before = seen.size();
      listGlass(static_cast<uint32_t>(count), seen);
      for (size_t i = before; i < seen.size(); ++i) seen[i].ray += static_cast<uint32_t>(first);
    }
    return seen;
  }

  void traceViews(std::span<const ViewFrame> views, uint32_t resolution,
                  std::span<uint32_t> triangles) override {
    const size_t most = viewsALaunch(resolution), view_pixels = size_t(resolution) * resolution;
    launch().resolution = resolution;
    for (size_t first = 0; first < views.size(); first += most) {
      const size_t count = std::min(most, views.size() - first), pixels = count * view_pixels;
      reserve(StageBuffer::view_triangles, pixels * 4, "images of triangle ids");
      put(StageBuffer::views, &views[first], count, "views");
      api_.run(GpuStage::kTraceViews, count * viewItems(resolution));
      api_.read(at(StageBuffer::view_triangles), &triangles[first * view_pixels], pixels * 4);
    }
  }

 protected:
  using Buffer = typename Api::Buffer;

  Api& api() { return api_; }
  StageLaunch& launch() { return api_.launch(); }
  uint32_t triangleCount() const { return triangle_count_; }
  /// For rays that no shader counted.
  void bookPixels(uint64_t rays) { rays_ += rays; }

  /// Runs a stage, again with a larger set as long as it was full (insertion is idempotent), and books the
  /// rays of one full run and what is new. Returns what countBits counted for a list.
  uint32_t traceUntilItFits(auto&& stage) {
    for (;;) {
      stage();
      countBits(set_.fresh(), set_.freshWords(), fresh_counts_, kFreshCounter);
      const auto counters = api_.takeCounters();
      if (counters[kOverflowCounter] == 0) {
        bookRays(counters);
        fresh_ = counters[kFreshCounter];
        return counters[kListCounter];
      }
      set_.grow(4);
    }
  }

  /// Makes a buffer larger if needed; contents are lost.
  void enlarge(Buffer& buffer, uint64_t bytes, const char* what) {
    if (buffer.bytes() > 0 && buffer.bytes() >= bytes) return;
    api_.release(buffer);
    buffer = api_.buffer(bytes, what);
  }

 private:
  /// Rays of one launch of traceRays: bounds the buffers.
  static constexpr size_t kRayChunk = 1u << 20;

  bool wantsHash(const DeviceOptions& options) const {
    if (options.set != SetKind::kAuto) return options.set == SetKind::kHash;
    return !api_.fits(uint64_t(triangle_count_) * 4);
  }

  /// Appends the glass of the rays that lie in the buffers, with room for more as long as there is too
  /// little.
  void listGlass(uint32_t rays, std::vector<SeenThrough>& seen) {
    static_assert(sizeof(SeenThrough) == 8);
    for (uint32_t room = std::max(rays, 1024u);;) {
      enlarge(glass_, uint64_t(room) * sizeof(SeenThrough), "list of glass");
      api_.bind(StageBuffer::indices, glass_);
      launch().list_end = room;
      api_.run(GpuStage::kTraceGlass, rays);
      const uint32_t found = api_.takeCounters()[kListCounter];
      if (found > room) {
        room = found;
        continue;
      }
      const size_t before = seen.size();
      seen.resize(before + found);
      if (found > 0) api_.read(glass_, &seen[before], found * sizeof(SeenThrough));
      std::sort(seen.begin() + std::ptrdiff_t(before), seen.end());
      seen.erase(std::unique(seen.begin() + std::ptrdiff_t(before), seen.end()), seen.end());
      return;
    }
  }

  /// Chooses the entries of a batch of border rays and makes their polygons; returns a bound of the number of
  /// rays: where everything fits in any case, nobody waits for the sum.
  uint32_t beginBorderBatch(uint32_t first, uint32_t most_rays) {
    const uint32_t pending = std::min(size_ - first, mostBorderEntries(most_rays, launch().params));
    const uint32_t blocks = (pending + kBorderBlock - 1) / kBorderBlock;
    launch().border_first = first;
    launch().border_count = pending;
    reserve(StageBuffer::border_starts, (uint64_t(pending) + 1) * 4, "numbers of border rays");
    Buffer& counts = at(StageBuffer::block_counts);
    reserve(StageBuffer::block_counts, (uint64_t(blocks) + 1) * 4, "counts of border rays");
    api_.run(GpuStage::kCountBorderRays, blocks);
    sumBlocks(blocks, kListCounter);
    api_.run(GpuStage::kSumBorderRays, blocks);
    uint64_t bound = uint64_t(pending) * borderRayCount(launch().params.counts.x, launch().params);
    if (bound > most_rays) {
      std::vector<uint32_t> sums(blocks + 1);
      api_.read(counts, sums.data(), sums.size() * 4);
      const auto after = std::upper_bound(sums.begin() + 1, sums.end(), most_rays);
      const auto taken = std::max(1u, static_cast<uint32_t>(after - sums.begin() - 1));
      launch().border_count = std::min(taken * kBorderBlock, pending);
      bound = sums[taken];
    }
    const uint32_t sides = launch().border_count * 3;
    reserve(StageBuffer::border_edges, uint64_t(sides) * sizeof(BorderEdge), "border polygons");
    api_.run(GpuStage::kBorderEdges, sides);
    return static_cast<uint32_t>(bound);
  }

  /// All border rays of the batch; of the original method level after level.
  void traceBorderRays(uint32_t total) {
    if (!isGvs(launch().params)) return api_.run(GpuStage::kTraceBorder, total);
    for (launch().level = 0; launch().level < kGvsLevels; ++launch().level) {
      api_.run(GpuStage::kTraceGvsBorder, uint64_t(launch().border_count) * gvsSlots(launch().level));
    }
  }

  void bookRays(const auto& counters) {
    rays_ += std::accumulate(counters.begin(), counters.begin() + kRayCounters, uint64_t(0));
  }

  void sumBlocks(uint32_t blocks, uint32_t place) {
    launch().block_count = blocks;
    launch().sum_place = place;
    api_.run(GpuStage::kSumBlocks, SL_SUM_ITEMS);
  }

  /// Binds bits and their counts; returns how many blocks there are.
  uint32_t bindBits(const Buffer& words, uint32_t word_count, Buffer& block_counts) {
    const uint32_t blocks = (word_count + kBlockWords - 1) / kBlockWords;
    launch().word_count = word_count;
    enlarge(block_counts, (uint64_t(blocks) + 1) * 4, "counts of bits");
    api_.bind(StageBuffer::words, words);
    api_.bind(StageBuffer::block_counts, block_counts);
    return blocks;
  }

  /// Counts bits, block by block, and all of them into the counter `place`.
  void countBits(const Buffer& words, uint32_t word_count, Buffer& block_counts, uint32_t place) {
    const uint32_t blocks = bindBits(words, word_count, block_counts);
    api_.run(GpuStage::kCountBits, blocks);
    sumBlocks(blocks, place);
  }

  /// Writes the indices of the bits that countBits counted to `indices`, ascending, and clears the bits.
  void writeIndices(const Buffer& words, uint32_t word_count, Buffer& block_counts, uint32_t total,
                    Buffer& indices, const char* what) {
    const uint32_t blocks = bindBits(words, word_count, block_counts);
    enlarge(indices, uint64_t(total) * 4, what);
    api_.bind(StageBuffer::indices, indices);
    api_.run(GpuStage::kWriteIndices, blocks);
  }

  Buffer& at(StageBuffer name) { return buffers_[uint32_t(name)]; }

  /// Makes a buffer larger if needed (contents are lost) and binds it.
  void reserve(StageBuffer name, uint64_t bytes, const char* what) {
    enlarge(at(name), bytes, what);
    api_.bind(name, at(name));
  }

  /// Fills a buffer, and binds it.
  template <typename T>
  void put(StageBuffer name, const T* data, size_t count, const char* what) {
    reserve(name, count * sizeof(T), what);
    api_.write(at(name), data, count * sizeof(T));
  }

  void reserveEntries(uint32_t count) {
    growList(StageBuffer::entries, uint64_t(size_) * sizeof(PvsEntry), uint64_t(count) * sizeof(PvsEntry),
             uint64_t(triangle_count_) * sizeof(PvsEntry), "list of visible triangles");
  }

  /// Makes room for `bytes` in a list, at least doubling it, up to `most` where that is enough; keeps its
  /// first bytes.
  void growList(StageBuffer name, uint64_t kept, uint64_t bytes, uint64_t most, const char* what) {
    Buffer& list = at(name);
    if (list.bytes() > 0 && bytes <= list.bytes()) return;
    Buffer larger = api_.buffer(std::max(bytes, std::min(2 * list.bytes(), most)), what);
    api_.copy(list, larger, kept);
    api_.release(list);
    list = std::move(larger);
    api_.bind(name, list);
  }

  Api api_;
  bool has_glass_;
  uint32_t triangle_count_;
  GpuSet<Api> set_;
  std::array<Buffer, kStageBuffers> buffers_;  ///< those of the sampler, by name
  Buffer fresh_counts_, new_ids_;              ///< block_counts and indices of the new triangles
  Buffer glass_;                               ///< SeenThrough, of traceGlass
  std::vector<RandomSegment> segments_;        ///< of the batch
  uint32_t size_ = 0;                          ///< entries of the list
  uint32_t fresh_ = 0;                         ///< new triangles of the batch
  uint64_t rays_ = 0;
};

}  // namespace sightline
