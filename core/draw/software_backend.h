#pragma once
#include <optional>
#include <vector>

#include "core/draw/drawables.h"
#include "core/draw/query_backend.h"
#include "core/draw/software_image.h"
#include "core/draw/triangle_lists.h"

namespace sightline {

/// How SoftwareBackend answers.
struct SoftwareAnswers {
  uint32_t polls =
      0;  ///< an answer arrives when it has been asked for so many times (QueryBackend::arrived), or
          /// < has been waited for; those before it in its submit and in earlier ones then have, too
  bool of_all = false;  ///< against the depth of all opaque drawables, not of what has been drawn so far:
                        /// < answers that depend on no order
};

/// A QueryBackend that draws with the processor (SoftwareImage): bit for bit the same everywhere. Scene,
/// drawables and lists must outlive it.
class SoftwareBackend : public QueryBackend {
 public:
  SoftwareBackend(const Scene& scene, const Drawables& drawables, const TriangleLists* lists = nullptr,
                  const SoftwareAnswers& answers = {});

  void beginFrame(const Camera& camera) override;
  QueryId submit(std::span<const uint32_t> draws, std::span<const OcclusionQuery> queries) override;
  void submitList(uint32_t list) override;
  /// As visible, throws std::out_of_range for a query of an older frame, or of none.
  bool arrived(QueryId query) override;
  bool visible(QueryId query) override;
  void endFrame() override;

  /// What has been drawn.
  const SoftwareImage& image() const { return image_; }

 private:
  void drawDrawable(SoftwareImage& image, uint32_t drawable);

  const Drawables& drawables_;
  const TriangleLists* lists_;
  SoftwareAnswers options_;
  SoftwareImage image_;
  std::optional<SoftwareImage> all_;  ///< with of_all
  struct Answer {
    bool visible;
    uint32_t polls;
  };
  std::vector<Answer> answers_;  ///< by QueryId less first_
  QueryId first_ = 0;            ///< of the frame before
  QueryId frame_first_ = 0;      ///< of this frame
  QueryId arrived_ = 0;          ///< those with lower numbers have
};

}  // namespace sightline
