#include "core/device/opencl/opencl_device.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/device/opencl/opencl_scene.h"
#include "core/device/opencl/opencl_set.h"
#include "core/opencl/opencl_context.h"
#include "core/sampling/random_segment.h"
#include "core/sampling/stage_rays.h"
#include "core/shared/border.h"
#include "core/shared/gvs_border.h"
#include "core/shared/reverse.h"

namespace sightline {
namespace {

/// As in cl_kernels: words of the counters, words of bits that a work item counts, items that sum them up.
constexpr uint32_t kOverflowCounter = 0, kRayCounter = 1, kRayCounters = 256, kMissingCounter = 257,
                   kDiscontinuityCounter = 258, kFreshCounter = 259, kCounters = 260;
constexpr uint32_t kBlockWords = 64;
constexpr uint32_t kSumItems = 64;
/// Work-group size of the kernels that handle lists. Fixed: PoCL compiles a kernel anew for every size.
constexpr uint32_t kListGroup = 64;
/// Rays of one launch of traceRays: bounds the buffers.
constexpr size_t kRayChunk = 1u << 20;

/// A buffer that is made larger when needed; contents are lost.
struct Scratch {
  ClBuffer buffer;
  void reserve(OpenClContext& context, uint64_t bytes, const char* what) {
    if (buffer.bytes() >= bytes && buffer.get() != nullptr) return;
    buffer = ClBuffer();
    buffer = context.buffer(bytes, what);
  }
};

class OpenClDevice final : public Device {
 public:
  OpenClDevice(const std::string& selector, const Scene& scene, const Bvh& bvh, const DeviceOptions& options)
      : context_(selector),
        lanes_(options.rays_per_item > 0 ? options.rays_per_item : raysPerItem(context_)),
        triangle_count_(static_cast<uint32_t>(scene.triangles.size())) {
    if (options.memory_budget_bytes > 0) context_.limitMemory(options.memory_budget_bytes);
    buildKernels(context_, lanes_);
    // Groups of 64 rays keep the cores of a CPU evenly busy and fill the smallest unit of a GPU.
    local_ = options.work_group_size > 0 ? options.work_group_size : std::max(1u, 64 / lanes_);
    scene_ = uploadScene(context_, scene, bvh, lanes_);
    uploadRecordIndex(bvh);
    counters_ = context_.buffer(kCounters * 4, "counters");
    context_.fill(counters_, 0, counters_.bytes());
    set_ = std::make_unique<OpenClSet>(context_, counters_, triangle_count_, wantsHash(options));
    const char* names[] = {"traceRandom",
                           "countMissing",
                           "traceBorder",
                           "traceReverse",
                           "countBits",
                           "sumBlocks",
                           "writeIndices",
                           "appendEntries",
                           "insertContained",
                           "traceRaysKernel",
                           "traceViewsKernel",
                           "traceGvsBorder",
                           "countBorderRays",
                           "sumBorderRays",
                           "borderEdges",
                           "thinDiscontinuities",
                           "appendDiscontinuities",
                           "reverseItems"};
    ClKernel* kernels[] = {&random_,
                           &missing_,
                           &border_,
                           &reverse_,
                           &count_,
                           &sum_,
                           &write_,
                           &append_,
                           &contained_,
                           &rays_kernel_,
                           &views_kernel_,
                           &gvs_border_,
                           &count_rays_,
                           &sum_rays_,
                           &make_edges_,
                           &thin_,
                           &append_discontinuities_,
                           &make_items_};
    for (size_t i = 0; i < std::size(names); ++i) *kernels[i] = context_.kernel(names[i]);
    faces_ = context_.buffer(6 * sizeof(Face), "faces of the view cell");
    reserveEntries(1u << 16);
  }

  DeviceInfo info() const override { return context_.info(); }

  void beginCell(std::span<const Face> faces, const StageParams& params) override {
    context_.write(faces_, faces.data(), faces.size_bytes());
    params_ = params;
    set_->clear();
    segments_.clear();
    size_ = discontinuities_ = fresh_ = 0;
    rays_ = items_before_ = 0;
  }

  void traceRandom(const RandomSegment& segment) override {
    segments_.push_back(segment);
    const auto slots = static_cast<uint32_t>(slotCount(segment));
    traceUntilItFits([&] { launch(random_, slots, faces_, params_, segment, counters_); });
  }

  BorderBatch traceBorder(uint32_t first, uint32_t most_rays, bool listing) override {
    const uint32_t total = beginBorderBatch(first, most_rays);
    const uint32_t words = (total + 31) / 32;
    border_hits_.reserve(context_, uint64_t(total) * 4, "hits of border rays");
    bits_.reserve(context_, uint64_t(words) * 4, "bits of discontinuities");
    context_.fill(bits_.buffer, 0, uint64_t(words) * 4);
    if (isGvs(params_)) context_.fill(border_hits_.buffer, kNotTraced, uint64_t(total) * 4);
    const ClBuffer* kept = nullptr;
    traceUntilItFits([&] {
      if (isGvs(params_)) {
        launchGvsLevels();
      } else {
        launchOverBorder(border_, total, border_hits_.buffer, bits_.buffer, counters_);
      }
      if (!listing) return;
      kept = thinDiscontinuities(words);
      countBits(*kept, words, block_counts_, kDiscontinuityCounter);
    });
    return {border_count_, listing ? appendDiscontinuities(*kept, words) : 0};
  }

  void traceReverse(uint32_t first, uint32_t count) override {
    items_.reserve(context_, uint64_t(count) * sizeof(ReverseItem), "reverse samples");
    context_.launch(make_items_, count, kListGroup, scene_.nodes, scene_.triangles, scene_.reach, record_of_,
                    faces_, params_, entries_, discontinuity_list_, first, count, items_before_,
                    items_.buffer);
    const uint32_t total = count * reverseRayCount(params_);
    traceUntilItFits([&] { launch(reverse_, total, faces_, params_, items_.buffer, total, counters_); });
  }

  void dropDiscontinuities() override {
    items_before_ += discontinuities_;
    discontinuities_ = 0;
  }

  uint32_t collect(uint32_t stage) override {
    const uint32_t found = std::exchange(fresh_, 0u);
    if (found > 0) {
      writeIndices(set_->fresh(), set_->freshWords(), fresh_counts_, found, new_ids_,
                   "list of new triangles");
      reserveEntries(size_ + found);
      segment_buffer_.reserve(context_, segments_.size() * sizeof(RandomSegment), "random segments");
      if (!segments_.empty()) {
        context_.write(segment_buffer_.buffer, segments_.data(), segments_.size() * sizeof(RandomSegment));
      }
      items_.reserve(context_, 4, "reverse samples");
      edges_.reserve(context_, 4, "border polygons");
      starts_.reserve(context_, 4, "numbers of border rays");
      context_.launch(append_, found, kListGroup, set_->keys(), set_->winner(), set_->fresh(),
                      set_->overflow(), set_->capacity(), faces_, params_, entries_, size_, new_ids_.buffer,
                      found, stage, segment_buffer_.buffer, static_cast<uint32_t>(segments_.size()), entries_,
                      border_first_, edges_.buffer, starts_.buffer, border_count_, items_.buffer);
      size_ += found;
      set_->fit(size_);
    }
    segments_.clear();
    return found;
  }

  void insertContained(std::span<const uint32_t> triangles) override {
    if (triangles.empty()) return;
    const auto count = static_cast<uint32_t>(triangles.size());
    reserveEntries(size_ + count);
    set_->fit(size_ + count);
    new_ids_.reserve(context_, triangles.size_bytes(), "list of contained triangles");
    context_.write(new_ids_.buffer, triangles.data(), triangles.size_bytes());
    do {
      context_.launch(contained_, count, kListGroup, set_->keys(), set_->winner(), set_->fresh(),
                      set_->overflow(), set_->capacity(), entries_, size_, new_ids_.buffer, count);
    } while (takeCounters()[kOverflowCounter] != 0 && (set_->grow(4), true));
    size_ += count;
  }

  uint64_t countMissing(const RandomSegment& segment, uvec4 shifts) override {
    const auto slots = static_cast<uint32_t>(slotCount(segment));
    launch(missing_, slots, faces_, shifts, segment, counters_);
    takeCounters();
    bookRays();
    return last_counters_[kMissingCounter];
  }

  DeviceCounters counters() override { return {rays_, context_.allocatedBytes(), set_->capacity() > 0}; }

  std::vector<PvsEntry> readPvs() override {
    std::vector<PvsEntry> entries(size_);
    if (size_ > 0) context_.read(entries_, entries.data(), entries.size() * sizeof(PvsEntry));
    return entries;
  }

  void traceRays(std::span<const Ray> rays, std::span<Hit> hits) override {
    const size_t chunk = std::min(kRayChunk, rays.size());
    const ClBuffer input = context_.buffer(chunk * sizeof(Ray), "rays");
    const ClBuffer output = context_.buffer(chunk * sizeof(Hit), "hits");
    for (size_t first = 0; first < rays.size(); first += chunk) {
      const auto count = static_cast<uint32_t>(std::min(chunk, rays.size() - first));
      context_.write(input, &rays[first], count * sizeof(Ray));
      context_.launch(rays_kernel_, (count + lanes_ - 1) / lanes_, local_, scene_.nodes, scene_.triangles,
                      scene_.reach, input, output, count);
      context_.read(output, &hits[first], count * sizeof(Hit));
    }
  }

  void traceViews(std::span<const ViewFrame> views, uint32_t resolution,
                  std::span<uint32_t> triangles) override {
    const size_t most = viewsALaunch(resolution), view_pixels = size_t(resolution) * resolution;
    for (size_t first = 0; first < views.size(); first += most) {
      const size_t count = std::min(most, views.size() - first), pixels = count * view_pixels;
      views_.reserve(context_, count * sizeof(ViewFrame), "views");
      view_triangles_.reserve(context_, pixels * 4, "images of triangle ids");
      context_.write(views_.buffer, &views[first], count * sizeof(ViewFrame));
      const auto items = static_cast<uint32_t>(count) * viewItems(resolution);
      context_.launch(views_kernel_, (items + lanes_ - 1) / lanes_, local_, scene_.nodes, scene_.triangles,
                      scene_.reach, views_.buffer, resolution, items, view_triangles_.buffer);
      context_.readFast(view_triangles_.buffer, &triangles[first * view_pixels], pixels * 4);
    }
  }

 private:
  bool wantsHash(const DeviceOptions& options) const {
    if (options.set != SetKind::kAuto) return options.set == SetKind::kHash;
    return !context_.fits(uint64_t(triangle_count_) * 4);
  }

  /// id -> one of its records, for the corners of border triangles and occluders.
  void uploadRecordIndex(const Bvh& bvh) {
    std::vector<uint32_t> record_of(triangle_count_, 0);
    for (size_t i = bvh.references.size(); i-- > 0;) record_of[bvh.references[i]] = static_cast<uint32_t>(i);
    record_of_ = context_.buffer(record_of.size() * 4, "index of triangles");
    context_.write(record_of_, record_of.data(), record_of.size() * 4);
  }

  /// Launches a stage over `rays` rays with scene and set as its first arguments.
  template <typename... Args>
  void launch(const ClKernel& kernel, uint64_t rays, const Args&... args) {
    context_.launch(kernel, (rays + lanes_ - 1) / lanes_, local_, scene_.nodes, scene_.triangles,
                    scene_.reach, set_->keys(), set_->winner(), set_->fresh(), set_->overflow(),
                    set_->capacity(), args...);
  }

  /// The same of the batch of border rays.
  template <typename... Args>
  void launchOverBorder(const ClKernel& kernel, uint64_t rays, const Args&... args) {
    launch(kernel, rays, params_, entries_, border_first_, edges_.buffer, starts_.buffer, border_count_,
           args...);
  }

  /// Border rays of the original method, level after level.
  void launchGvsLevels() {
    for (uint32_t level = 0; level < kGvsLevels; ++level) {
      const uint32_t slots = border_count_ * gvsSlots(level);
      launchOverBorder(gvs_border_, slots, record_of_, level, slots, border_hits_.buffer, bits_.buffer,
                       counters_);
    }
  }

  /// Chooses the entries of a batch of border rays and makes their polygons; returns a bound of the number of
  /// rays: where everything fits in any case, nobody waits for the sum.
  uint32_t beginBorderBatch(uint32_t first, uint32_t most_rays) {
    const uint32_t pending = std::min(size_ - first, mostBorderEntries(most_rays, params_));
    const uint32_t blocks = (pending + kBorderBlock - 1) / kBorderBlock;
    starts_.reserve(context_, (uint64_t(pending) + 1) * 4, "numbers of border rays");
    block_counts_.reserve(context_, (uint64_t(blocks) + 1) * 4, "counts of border rays");
    context_.launch(count_rays_, blocks, kListGroup, scene_.nodes, scene_.triangles, scene_.reach, record_of_,
                    params_, entries_, first, pending, blocks, starts_.buffer, block_counts_.buffer);
    context_.launch(sum_, kSumItems, kSumItems, block_counts_.buffer, blocks, counters_, 0u);
    context_.launch(sum_rays_, blocks, kListGroup, pending, blocks, block_counts_.buffer, starts_.buffer);
    border_first_ = first;
    border_count_ = pending;
    uint64_t bound = uint64_t(pending) * borderRayCount(params_.counts.x, params_);
    if (bound > most_rays) {
      std::vector<uint32_t> sums(blocks + 1);
      context_.read(block_counts_.buffer, sums.data(), sums.size() * 4);
      const auto after = std::upper_bound(sums.begin() + 1, sums.end(), most_rays);
      const auto taken = std::max(1u, static_cast<uint32_t>(after - sums.begin() - 1));
      border_count_ = std::min(taken * kBorderBlock, pending);
      bound = sums[taken];
    }
    const uint32_t sides = border_count_ * 3;
    edges_.reserve(context_, uint64_t(sides) * sizeof(BorderEdge), "border polygons");
    context_.launch(make_edges_, sides, kListGroup, scene_.nodes, scene_.triangles, scene_.reach, record_of_,
                    params_, entries_, first, sides, edges_.buffer);
    return static_cast<uint32_t>(bound);
  }

  /// Bits of the batch's discontinuities that get reverse rays.
  const ClBuffer* thinDiscontinuities(uint32_t words) {
    if (isGvs(params_) || params_.method.y == 1) return &bits_.buffer;
    kept_bits_.reserve(context_, uint64_t(words) * 4, "bits of discontinuities");
    context_.launch(thin_, words, kListGroup, params_, entries_, border_first_, edges_.buffer, starts_.buffer,
                    border_count_, border_hits_.buffer, bits_.buffer, words, kept_bits_.buffer);
    return &kept_bits_.buffer;
  }

  /// Appends the discontinuities of these bits, which were counted last; returns their number.
  uint32_t appendDiscontinuities(const ClBuffer& bits, uint32_t words) {
    const uint32_t found = last_counters_[kDiscontinuityCounter];
    if (found == 0) return 0;
    writeIndices(bits, words, block_counts_, found, indices_, "indices of discontinuities");
    growList(discontinuity_list_, uint64_t(discontinuities_) * sizeof(Discontinuity),
             (uint64_t(discontinuities_) + found) * sizeof(Discontinuity), ~uint64_t(0),
             "list of discontinuities");
    context_.launch(append_discontinuities_, found, kListGroup, entries_, border_first_, edges_.buffer,
                    starts_.buffer, border_count_, border_hits_.buffer, indices_.buffer, found,
                    discontinuity_list_, discontinuities_);
    discontinuities_ += found;
    return found;
  }

  /// Runs a stage, again with a larger set as long as it was full (insertion is idempotent), and books the
  /// rays of one full run and what is new.
  void traceUntilItFits(auto&& stage) {
    for (;;) {
      stage();
      countBits(set_->fresh(), set_->freshWords(), fresh_counts_, kFreshCounter);
      takeCounters();
      if (last_counters_[kOverflowCounter] == 0) break;
      set_->grow(4);
    }
    bookRays();
    fresh_ = last_counters_[kFreshCounter];
  }

  /// Adds up the rays of the counters taken last.
  void bookRays() {
    const auto rays = last_counters_.begin() + kRayCounter;
    rays_ += std::accumulate(rays, rays + kRayCounters, uint64_t(0));
  }

  /// Waits for all launches, reads the counters and sets them back to 0.
  const std::vector<uint32_t>& takeCounters() {
    context_.read(counters_, last_counters_.data(), last_counters_.size() * 4);
    context_.fill(counters_, 0, counters_.bytes());
    return last_counters_;
  }

  /// Counts bits, block by block, and all of them into a word of the counters.
  void countBits(const ClBuffer& words, uint32_t word_count, Scratch& block_counts, uint32_t place) {
    const uint32_t blocks = (word_count + kBlockWords - 1) / kBlockWords;
    block_counts.reserve(context_, (uint64_t(blocks) + 1) * 4, "counts of bits");
    context_.launch(count_, blocks, kListGroup, words, word_count, blocks, block_counts.buffer);
    context_.launch(sum_, kSumItems, kSumItems, block_counts.buffer, blocks, counters_, place);
  }

  /// Writes the indices of the bits that countBits counted to `indices`, ascending, and clears the bits.
  void writeIndices(const ClBuffer& words, uint32_t word_count, const Scratch& block_counts, uint32_t total,
                    Scratch& indices, const char* what) {
    const uint32_t blocks = (word_count + kBlockWords - 1) / kBlockWords;
    indices.reserve(context_, uint64_t(total) * 4, what);
    context_.launch(write_, blocks, kListGroup, words, word_count, blocks, block_counts.buffer,
                    indices.buffer);
  }

  void reserveEntries(uint32_t count) {
    growList(entries_, uint64_t(size_) * sizeof(PvsEntry), uint64_t(count) * sizeof(PvsEntry),
             uint64_t(triangle_count_) * sizeof(PvsEntry), "list of visible triangles");
  }

  /// Makes room for `bytes` in a list, at least doubling it, up to `most` where that is enough; keeps its
  /// first bytes.
  void growList(ClBuffer& list, uint64_t kept, uint64_t bytes, uint64_t most, const char* what) {
    if (list.get() != nullptr && bytes <= list.bytes()) return;
    ClBuffer larger = context_.buffer(std::max(bytes, std::min(2 * list.bytes(), most)), what);
    context_.copy(list, larger, kept);
    context_.finish();
    list = std::move(larger);
  }

  OpenClContext context_;
  uint32_t lanes_;  ///< rays a work item
  uint32_t local_ = 0;
  uint32_t triangle_count_;
  OpenClScene scene_;
  ClBuffer record_of_, faces_, counters_, entries_, discontinuity_list_;
  ClKernel random_, missing_, border_, reverse_, count_, sum_, write_, append_, contained_, rays_kernel_,
      views_kernel_, gvs_border_, count_rays_, sum_rays_, make_edges_, thin_, append_discontinuities_,
      make_items_;
  std::unique_ptr<OpenClSet> set_;
  StageParams params_{};
  std::vector<RandomSegment> segments_;  ///< of the batch
  Scratch segment_buffer_, starts_, edges_, border_hits_, bits_, kept_bits_, indices_, items_, new_ids_,
      block_counts_, fresh_counts_, views_, view_triangles_;
  uint32_t size_ = 0;             ///< entries of the list
  uint32_t border_first_ = 0;     ///< first entry of the batch of border rays
  uint32_t border_count_ = 0;     ///< its entries
  uint32_t discontinuities_ = 0;  ///< in their list
  uint64_t items_before_ = 0;     ///< those of the cell that were dropped
  std::vector<uint32_t> last_counters_ = std::vector<uint32_t>(kCounters);
  uint32_t fresh_ = 0;  ///< new triangles of the batch
  uint64_t rays_ = 0;
};

}  // namespace

std::unique_ptr<Device> makeOpenClDevice(const std::string& selector, const Scene& scene, const Bvh& bvh,
                                         const DeviceOptions& options) {
  return std::make_unique<OpenClDevice>(selector, scene, bvh, options);
}

}  // namespace sightline
