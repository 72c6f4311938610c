#include "core/draw/software_backend.h"

#include <algorithm>

namespace sightline {

SoftwareBackend::SoftwareBackend(const Scene& scene, const Drawables& drawables, const TriangleLists* lists,
                                 const SoftwareAnswers& answers)
    : drawables_(drawables), lists_(lists), options_(answers), image_(scene) {
  if (answers.of_all) all_.emplace(scene);
}

void SoftwareBackend::beginFrame(const Camera& camera) {
  answers_.erase(answers_.begin(), answers_.begin() + ptrdiff_t(frame_first_ - first_));
  first_ = frame_first_;
  frame_first_ = first_ + answers_.size();
  image_.begin(camera);
  if (!all_) return;
  all_->begin(camera);
  for (uint32_t d = 0; d < drawables_.list.size(); ++d) {
    if (drawables_.list[d].alpha == AlphaKind::opaque) drawDrawable(*all_, d);
  }
}

QueryId SoftwareBackend::submit(std::span<const uint32_t> draws, std::span<const OcclusionQuery> queries) {
  for (const uint32_t d : draws) drawDrawable(image_, d);
  const QueryId first = first_ + answers_.size();
  for (const OcclusionQuery& query : queries) {
    const SoftwareImage& against = all_ ? *all_ : image_;
    answers_.push_back({std::any_of(query.boxes.begin(), query.boxes.end(),
                                    [&](const AxisBox& box) { return against.seesBox(box); }),
                        options_.polls});
  }
  return first;
}

void SoftwareBackend::submitList(uint32_t list) {
  const TriangleList& l = lists_->lists[list];
  for (uint32_t i = 0; i < l.ids.size(); ++i) image_.draw(l.ids[i], i < l.blended_begin);
}

bool SoftwareBackend::arrived(QueryId query) {
  if (query < arrived_) return true;
  uint32_t& polls = answers_.at(query - first_).polls;
  if (polls > 0) {
    --polls;
    return false;
  }
  arrived_ = query + 1;
  return true;
}

bool SoftwareBackend::visible(QueryId query) {
  const bool answer = answers_.at(query - first_).visible;
  arrived_ = std::max(arrived_, query + 1);
  return answer;
}

void SoftwareBackend::endFrame() {}

void SoftwareBackend::drawDrawable(SoftwareImage& image, uint32_t drawable) {
  const bool writes = drawables_.list[drawable].alpha != AlphaKind::blended;
  for (const uint32_t id : drawables_.trianglesOf(drawable)) image.draw(id, writes);
}

}  // namespace sightline
