#include "core/device/vulkan/vulkan_device.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/device/vulkan/vulkan_raster.h"
#include "core/device/vulkan/vulkan_scene.h"
#include "core/device/vulkan/vulkan_set.h"
#include "core/sampling/random_segment.h"
#include "core/sampling/stage_rays.h"
#include "core/shared/border.h"
#include "core/shared/gvs_border.h"
#include "core/shared/hemicube.h"
#include "core/shared/reverse.h"
#include "core/trace/parallel_copy.h"

namespace sightline {
namespace {

/// Rays of one launch of traceRays: bounds the buffers.
constexpr size_t kRayChunk = 1u << 20;
/// Read back at once. The buffer is kept, as those of uploads are: the H200's driver takes 4 ms to make 16
/// MiB.
constexpr uint64_t kReadbackBytes = 64u << 20;
/// Work items of a group with ray queries, if the options name no other.
constexpr uint32_t kGroup = 64;

class VulkanDevice final : public Device, private HemicubeDrawer {
 public:
  VulkanDevice(const std::string& selector, const Scene& scene, const Bvh& bvh, const DeviceOptions& options)
      : context_(selector, options.ray_queries, options.memory_budget_bytes),
        runner_(context_),
        launch_(runner_.launch),
        group_(options.work_group_size > 0 ? options.work_group_size : kGroup),
        triangle_count_(static_cast<uint32_t>(scene.triangles.size())),
        scene_(uploadVulkanScene(context_, scene, bvh, options.part_triangles)),
        set_(context_, runner_, triangle_count_, wantsHash(options)) {
    scene_.describe(launch_);
    count_ = VulkanStage::list(context_, "count_bits");
    sum_ = VulkanStage::list(context_, "sum_blocks");
    write_ = VulkanStage::list(context_, "write_indices");
    count_rays_ = VulkanStage::list(context_, "count_border_rays");
    sum_rays_ = VulkanStage::list(context_, "sum_border_rays");
    edges_ = VulkanStage::list(context_, "border_edges");
    thin_ = VulkanStage::list(context_, "thin_discontinuities");
    append_discontinuities_ = VulkanStage::list(context_, "append_discontinuities");
    reverse_list_ = VulkanStage::list(context_, "reverse_items");
    append_ = VulkanStage::list(context_, "append_entries");
    contained_ = VulkanStage::list(context_, "insert_contained");
    pixels_ = VulkanStage::list(context_, "insert_pixels");
    faces_ = context_.buffer(6 * sizeof(Face), "faces of the view cell");
    launch_.faces = faces_.address();
    reserveEntries(1u << 16);
  }

  DeviceInfo info() const override {
    DeviceInfo info = context_.info();
    info.driver_tree_parts = static_cast<uint32_t>(scene_.tree.parts.size());
    info.driver_tree_bytes = scene_.tree.bytes;
    info.driver_tree_build_seconds = scene_.tree.build_seconds;
    return info;
  }

  void beginCell(std::span<const Face> faces, const StageParams& params) override {
    runner_.commands.update(faces_, faces.data(), faces.size_bytes());
    launch_.params = params;
    launch_.items_before = 0;
    set_.clear();
    segments_.clear();
    hemicubes_.clear();
    launch_.waiting = 0;
    size_ = fresh_ = 0;
    rays_ = 0;
  }

  void traceRandom(const RandomSegment& segment) override {
    segments_.push_back(segment);
    launch_.segment = segment;
    launch_.shifts = launch_.params.shifts;
    const auto slots = static_cast<uint32_t>(slotCount(segment));
    traceUntilItFits([&] { runner_.run(tracing(random_, "trace_random"), slots); });
  }

  BorderBatch traceBorder(uint32_t first, uint32_t most_rays, bool listing) override {
    const uint32_t total = beginBorderBatch(first, most_rays);
    const uint32_t words = (total + 31) / 32;
    const bool thin = listing && !isGvs(launch_.params) && launch_.params.method.y > 1;
    reserve(border_hits_, launch_.border_hits, uint64_t(total) * 4, "hits of border rays");
    reserve(bits_, launch_.bits, uint64_t(words) * 4, "bits of discontinuities");
    if (thin) reserve(kept_bits_, launch_.kept_bits, uint64_t(words) * 4, "bits of discontinuities");
    runner_.commands.fill(bits_, 0, uint64_t(words) * 4);
    if (isGvs(launch_.params)) runner_.commands.fill(border_hits_, kNotTraced, uint64_t(total) * 4);
    const uint32_t found = traceUntilItFits([&] {
      traceBorderRays(launch_.border_count, total);
      if (thin) runner_.run(thin_, words);
      if (listing) countBits(thin ? kept_bits_ : bits_, words, block_counts_, kListCounter);
    });
    if (listing && found > 0) {
      writeIndices(thin ? kept_bits_ : bits_, words, block_counts_, found, indices_,
                   "indices of discontinuities");
      growList(waiting_, launch_.discontinuities, uint64_t(launch_.waiting) * sizeof(Discontinuity),
               (uint64_t(launch_.waiting) + found) * sizeof(Discontinuity), ~uint64_t(0),
               "list of discontinuities");
      runner_.run(append_discontinuities_, found);
      launch_.waiting += found;
    }
    return {launch_.border_count, listing ? found : 0};
  }

  void dropDiscontinuities() override {
    launch_.items_before += launch_.waiting;
    launch_.waiting = 0;
  }

  void traceReverse(uint32_t first, uint32_t count) override {
    launch_.reverse_first = first;
    const uint32_t total = count * reverseRayCount(launch_.params);
    reserve(reverse_items_, launch_.reverse_items, uint64_t(count) * sizeof(ReverseItem), "reverse samples");
    runner_.run(reverse_list_, count);
    traceUntilItFits([&] { runner_.run(tracing(reverse_, "trace_reverse"), total); });
  }

  HemicubeDrawer& drawer() override { return *this; }

  void rasterize(std::span<const ViewFrame> hemicube, uint32_t resolution, float near_distance) override {
    if (!raster_ || raster_->resolution() != resolution) {
      runner_.commands.finish();
      raster_.reset();
      raster_.emplace(context_, runner_, resolution, triangle_count_);
    }
    const uint32_t samples = hemicubeSamples(resolution);
    reserve(hemicube_, launch_.hemicube, hemicube.size_bytes(), "views of a hemicube");
    updateInPieces(hemicube_, hemicube.data(), hemicube.size());
    launch_.raster_resolution = resolution;
    launch_.raster_first = static_cast<uint32_t>(hemicubes_.size() / kHemicubeViews * samples + 1);
    launch_.raster_near = near_distance;
    raster_->draw();
    traceUntilItFits([&] { runner_.run(pixels_, samples); });
    hemicubes_.insert(hemicubes_.end(), hemicube.begin(), hemicube.end());
    rays_ += samples;
  }

  uint32_t collect(uint32_t stage) override {
    const uint32_t found = std::exchange(fresh_, 0u);
    if (found > 0) {
      writeIndices(set_.fresh(), set_.freshWords(), fresh_counts_, found, new_ids_, "list of new triangles");
      reserveEntries(size_ + found);
      reserve(segment_buffer_, launch_.segments, segments_.size() * sizeof(RandomSegment), "random segments");
      updateInPieces(segment_buffer_, segments_.data(), segments_.size());
      launch_.segment_count = static_cast<uint32_t>(segments_.size());
      launch_.hemicubes = 0;
      if (!hemicubes_.empty()) {
        reserve(hemicube_batch_, launch_.hemicubes, hemicubes_.size() * sizeof(ViewFrame), "hemicubes");
        updateInPieces(hemicube_batch_, hemicubes_.data(), hemicubes_.size());
      }
      launch_.stage = stage;
      launch_.list_end = size_;
      runner_.run(append_, found);
      size_ += found;
      set_.fit(size_);
    }
    segments_.clear();
    hemicubes_.clear();
    return found;
  }

  void insertContained(std::span<const uint32_t> triangles) override {
    if (triangles.empty()) return;
    const auto count = static_cast<uint32_t>(triangles.size());
    reserveEntries(size_ + count);
    set_.fit(size_ + count);
    reserve(new_ids_, launch_.indices, triangles.size_bytes(), "list of contained triangles");
    runner_.commands.finish();
    upload(new_ids_, triangles.data(), triangles.size_bytes());
    launch_.list_end = size_;
    traceUntilItFits([&] { runner_.run(contained_, count); });
    size_ += count;
  }

  uint64_t countMissing(const RandomSegment& segment, uvec4 shifts) override {
    launch_.segment = segment;
    launch_.shifts = shifts;
    runner_.run(tracing(missing_, "count_missing"), static_cast<uint32_t>(slotCount(segment)));
    const VulkanCounts counts = runner_.takeCounts();
    rays_ += counts.rays;
    return counts.missing;
  }

  DeviceCounters counters() override { return {rays_, context_.allocatedBytes(), set_.capacity() > 0}; }

  std::vector<PvsEntry> readPvs() override {
    std::vector<PvsEntry> entries(size_);
    read(entries_, entries.data(), entries.size() * sizeof(PvsEntry));
    return entries;
  }

  void traceRays(std::span<const Ray> rays, std::span<Hit> hits) override {
    const size_t chunk = std::min(kRayChunk, rays.size());
    reserve(rays_buffer_, launch_.rays, chunk * sizeof(Ray), "rays");
    reserve(hits_buffer_, launch_.hits, chunk * sizeof(Hit), "hits");
    for (size_t first = 0; first < rays.size(); first += chunk) {
      const auto count = static_cast<uint32_t>(std::min(chunk, rays.size() - first));
      upload(rays_buffer_, &rays[first], count * sizeof(Ray));
      runner_.run(tracing(rays_stage_, "trace_rays"), count);
      read(hits_buffer_, &hits[first], count * sizeof(Hit));
    }
  }

  void traceViews(std::span<const ViewFrame> views, uint32_t resolution,
                  std::span<uint32_t> triangles) override {
    const size_t most = viewsALaunch(resolution), view_pixels = size_t(resolution) * resolution;
    launch_.resolution = resolution;
    for (size_t first = 0; first < views.size(); first += most) {
      const size_t count = std::min(most, views.size() - first), bytes = count * view_pixels * 4;
      reserve(views_, launch_.rays, count * sizeof(ViewFrame), "views");
      reserve(view_triangles_, launch_.hits, bytes, "images of triangle ids");
      updateInPieces(views_, &views[first], count);
      runner_.run(tracing(views_stage_, "trace_views"), static_cast<uint32_t>(count) * viewItems(resolution));
      read(view_triangles_, &triangles[first * view_pixels], bytes);
    }
  }

 private:
  bool wantsHash(const DeviceOptions& options) const {
    if (options.set != SetKind::kAuto) return options.set == SetKind::kHash;
    return !context_.fits(uint64_t(triangle_count_) * 4);
  }

  /// The stage, made when it is first needed: drivers take up to a second to compile one.
  const VulkanStage& tracing(std::optional<VulkanStage>& stage, const char* name) {
    if (!stage) stage = VulkanStage::tracing(context_, name, group_);
    return *stage;
  }

  /// Runs a stage, again with a larger set as long as it was full (insertion is idempotent), and counts the
  /// rays of one full run, and what is new. Returns VulkanCounts::listed.
  uint32_t traceUntilItFits(auto&& stage) {
    for (;;) {
      stage();
      countBits(set_.fresh(), set_.freshWords(), fresh_counts_, kFreshCounter);
      const VulkanCounts counts = runner_.takeCounts();
      if (!counts.overflow) {
        rays_ += counts.rays;
        fresh_ = counts.fresh;
        return counts.listed;
      }
      set_.grow(4);
    }
  }

  /// Chooses the entries of a batch of border rays and makes their polygons; returns a bound of the number of
  /// rays: where everything fits in any case, nobody waits for the sum.
  uint32_t beginBorderBatch(uint32_t first, uint32_t most_rays) {
    const uint32_t pending = std::min(size_ - first, mostBorderEntries(most_rays, launch_.params));
    const uint32_t blocks = (pending + kBorderBlock - 1) / kBorderBlock;
    launch_.border_first = first;
    launch_.border_count = pending;
    launch_.block_count = blocks;
    reserve(border_starts_, launch_.border_starts, (uint64_t(pending) + 1) * 4, "numbers of border rays");
    reserve(block_counts_, launch_.block_counts, uint64_t(blocks) * 4, "counts of border rays");
    runner_.run(count_rays_, blocks);
    launch_.sum_place = kListCounter;
    runner_.run(sum_, kSumItems);
    runner_.run(sum_rays_, blocks);
    uint64_t bound = uint64_t(pending) * borderRayCount(launch_.params.counts.x, launch_.params);
    if (bound > most_rays) {
      std::vector<uint32_t> sums(blocks + 1);
      sums.back() = runner_.takeCounts().listed;
      read(block_counts_, sums.data(), uint64_t(blocks) * 4);
      const auto after = std::upper_bound(sums.begin() + 1, sums.end(), most_rays);
      const auto taken = std::max(1u, static_cast<uint32_t>(after - sums.begin() - 1));
      launch_.border_count = std::min(taken * kBorderBlock, pending);
      bound = sums[taken];
    }
    const uint32_t sides = launch_.border_count * 3;
    reserve(border_edges_, launch_.border_edges, uint64_t(sides) * sizeof(BorderEdge), "border polygons");
    runner_.run(edges_, sides);
    return static_cast<uint32_t>(bound);
  }

  /// All border rays of `count` entries; of the original method level after level.
  void traceBorderRays(uint32_t count, uint32_t total) {
    if (!isGvs(launch_.params)) return runner_.run(tracing(border_, "trace_border"), total);
    for (launch_.level = 0; launch_.level < kGvsLevels; ++launch_.level) {
      runner_.run(tracing(gvs_border_, "trace_gvs_border"), count * gvsSlots(launch_.level));
    }
  }

  /// Makes a buffer larger if needed (contents are lost) and puts its address into the launch.
  void reserve(VulkanBuffer& buffer, uint64& address, uint64_t bytes, const char* what) {
    if (buffer.bytes() < bytes || buffer.get() == VK_NULL_HANDLE) {
      runner_.commands.finish();
      buffer = VulkanBuffer();
      buffer = context_.buffer(bytes, what);
    }
    address = buffer.address();
  }

  /// Counts bits, block by block, and all of them into the counter `place`.
  void countBits(const VulkanBuffer& words, uint32_t word_count, VulkanBuffer& block_counts, uint32_t place) {
    describeBits(words, word_count);
    reserve(block_counts, launch_.block_counts, uint64_t(launch_.block_count) * 4, "counts of bits");
    launch_.sum_place = place;
    runner_.run(count_, launch_.block_count);
    runner_.run(sum_, kSumItems);
  }

  /// Writes the indices of the bits that countBits counted to `indices`, ascending, and clears the bits.
  void writeIndices(const VulkanBuffer& words, uint32_t word_count, const VulkanBuffer& block_counts,
                    uint32_t total, VulkanBuffer& indices, const char* what) {
    describeBits(words, word_count);
    launch_.block_counts = block_counts.address();
    reserve(indices, launch_.indices, uint64_t(total) * 4, what);
    runner_.run(write_, launch_.block_count);
  }

  void describeBits(const VulkanBuffer& words, uint32_t word_count) {
    launch_.words = words.address();
    launch_.word_count = word_count;
    launch_.block_count = (word_count + kBlockWords - 1) / kBlockWords;
  }

  template <typename T>
  void updateInPieces(const VulkanBuffer& buffer, const T* data, size_t count) {
    constexpr size_t kPiece = 65536 / sizeof(T);
    for (size_t first = 0; first < count; first += kPiece) {
      const size_t some = std::min(kPiece, count - first);
      runner_.commands.update(buffer, &data[first], some * sizeof(T), first * sizeof(T));
    }
  }

  /// Waits until the data has arrived.
  void upload(const VulkanBuffer& target, const void* data, uint64_t bytes) {
    if (!upload_) upload_.emplace(context_);
    upload_->write(target, data, bytes);
    upload_->finish();
  }

  void read(const VulkanBuffer& buffer, void* target, uint64_t bytes) {
    if (readback_.bytes() < std::min(bytes, kReadbackBytes)) {
      readback_ = VulkanBuffer();
      readback_ = context_.buffer(std::min(bytes, kReadbackBytes), "staging memory", VulkanMemory::kReadback);
    }
    for (uint64_t first = 0; first < bytes; first += kReadbackBytes) {
      const uint64_t count = std::min(bytes - first, kReadbackBytes);
      runner_.commands.copy(buffer, readback_, count, first);
      runner_.takeCounts();
      parallelCopy(static_cast<char*>(target) + first, readback_.mapped(), count);
    }
  }

  void reserveEntries(uint32_t count) {
    growList(entries_, launch_.entries, uint64_t(size_) * sizeof(PvsEntry),
             uint64_t(count) * sizeof(PvsEntry), uint64_t(triangle_count_) * sizeof(PvsEntry),
             "list of visible triangles");
  }

  /// Makes room for `bytes` in a list, at least doubling it, up to `most` where that is enough; keeps its
  /// first bytes, and puts its address into the launch.
  void growList(VulkanBuffer& list, uint64& address, uint64_t kept, uint64_t bytes, uint64_t most,
                const char* what) {
    if (list.get() != VK_NULL_HANDLE && bytes <= list.bytes()) return;
    VulkanBuffer larger = context_.buffer(std::max(bytes, std::min(2 * list.bytes(), most)), what);
    runner_.commands.copy(list, larger, kept);
    runner_.commands.finish();
    list = std::move(larger);
    address = list.address();
  }

  VulkanContext context_;
  VulkanRunner runner_;
  VulkanLaunch& launch_;
  uint32_t group_;
  uint32_t triangle_count_;
  VulkanScene scene_;
  VulkanSet set_;
  VulkanBuffer faces_, entries_, segment_buffer_, border_starts_, border_edges_, border_hits_, bits_,
      kept_bits_, indices_, waiting_, new_ids_, block_counts_, fresh_counts_, reverse_items_, rays_buffer_,
      hits_buffer_, views_, view_triangles_, hemicube_, hemicube_batch_, readback_;
  std::optional<VulkanUpload> upload_;
  VulkanStage count_, sum_, write_, count_rays_, sum_rays_, edges_, thin_, append_discontinuities_,
      reverse_list_, append_, contained_, pixels_;
  std::optional<VulkanStage> random_, missing_, border_, reverse_, rays_stage_, views_stage_, gvs_border_;
  std::optional<VulkanRaster> raster_;   ///< made when it is first needed
  std::vector<RandomSegment> segments_;  ///< of the batch
  std::vector<ViewFrame> hemicubes_;     ///< of the batch, five views each
  uint32_t size_ = 0;                    ///< entries of the list
  uint32_t fresh_ = 0;                   ///< new triangles of the batch
  uint64_t rays_ = 0;
};

}  // namespace

std::unique_ptr<Device> makeVulkanDevice(const std::string& selector, const Scene& scene, const Bvh& bvh,
                                         const DeviceOptions& options) {
  return std::make_unique<VulkanDevice>(selector, scene, bvh, options);
}

}  // namespace sightline
