#include "core/draw/frame_recorder.h"

#include <algorithm>

namespace sightline {
namespace {

/// Ticks from one look in vain for an answer to the next. A tick takes a fraction of a microsecond, and an
/// answer some fifty: what comes so much later is not missed.
constexpr uint32_t kTicksALook = 8;

}  // namespace

FrameRecorder::FrameRecorder(const Drawables& drawables, const Camera& camera, QueryBackend& backend,
                             std::vector<uint32_t>& drawn, const Schedule& schedule)
    : drawables_(drawables),
      camera_(camera),
      backend_(backend),
      guard_(camera),
      drawn_(drawn),
      schedule_(schedule) {
  drawn_.clear();
  backend_.beginFrame(camera);
}

void FrameRecorder::draw(uint32_t drawable) {
  switch (drawables_.list[drawable].alpha) {
    case AlphaKind::opaque:
      return render_queue_.push_back(drawable);
    case AlphaKind::masked:
      return masked_.push_back(drawable);
    case AlphaKind::blended:
      return blended_.push_back(drawable);
  }
}

uint32_t FrameRecorder::ask(std::span<const AxisBox> boxes) {
  asked_boxes_.insert(asked_boxes_.end(), boxes.begin(), boxes.end());
  asked_ends_.push_back(static_cast<uint32_t>(asked_boxes_.size()));
  return static_cast<uint32_t>(asked_ends_.size() - 1);
}

QueryId FrameRecorder::submit(bool draws) {
  if (!draws) {
    submitNow({});
  } else {
    submitNow(render_queue_);
    render_queue_.clear();
  }
  return submitted_;
}

void FrameRecorder::submitNow(const std::vector<uint32_t>& draws) {
  if (draws.empty() && !asksAnything()) return;
  queries_.clear();
  uint32_t begin = 0;
  for (const uint32_t end : asked_ends_) {
    queries_.push_back({std::span(asked_boxes_).subspan(begin, end - begin)});
    begin = end;
  }
  counts.query_boxes += asked_boxes_.size();
  submitted_ = backend_.submit(draws, queries_);
  if (!queries_.empty()) submit_ends_.push_back(submitted_ + queries_.size());
  ++counts.submits;
  counts.queries += queries_.size();
  counts.draws += draws.size();
  counts.objects += draws.size();
  for (const uint32_t d : draws) counts.triangles += drawables_.list[d].triangle_count;
  drawn_.insert(drawn_.end(), draws.begin(), draws.end());
  asked_boxes_.clear();
  asked_ends_.clear();
}

bool FrameRecorder::arrived(QueryId query, uint64_t ticks, bool now) {
  if (schedule_.fixed) return ticks >= schedule_.ticks;
  if (ticks_to_look_ > 0 && !now) {
    --ticks_to_look_;
    return false;
  }
  if (backend_.arrived(query)) return true;
  ticks_to_look_ = kTicksALook - 1;
  return false;
}

bool FrameRecorder::visible(QueryId query) {
  if (schedule_.fixed) {
    if (query >= waited_for_) {
      ++counts.waits;
      waited_for_ = *std::upper_bound(submit_ends_.begin(), submit_ends_.end(), query);
    }
  } else if (!backend_.arrived(query)) {
    ++counts.waits;
  }
  return backend_.visible(query);
}

void FrameRecorder::sortBlended() {
  struct Far {
    double distance;
    uint32_t drawable;
  };
  std::vector<Far> order;
  const glm::dvec3 forward(camera_.forward.x, camera_.forward.y, camera_.forward.z);
  for (const uint32_t d : blended_) {
    const AxisBox& box = drawables_.list[d].box;
    double distance = 0;
    for (int axis = 0; axis < 3; ++axis) {
      distance += forward[axis] * ((double(box.low[axis]) + box.high[axis]) / 2 - camera_.eye[axis]);
    }
    order.push_back({distance, d});
  }
  std::sort(order.begin(), order.end(), [](const Far& a, const Far& b) {
    return a.distance != b.distance ? a.distance > b.distance : a.drawable > b.drawable;
  });
  for (size_t i = 0; i < order.size(); ++i) blended_[i] = order[i].drawable;
}

QueryId FrameRecorder::finish() {
  std::vector<uint32_t> last = std::move(render_queue_);
  std::reverse(masked_.begin(), masked_.end());
  sortBlended();
  // Queries must not see what is masked, so it goes into a submit of its own where any are left.
  const bool apart = asksAnything();
  if (apart) {
    submitNow(last);
    last.clear();
  }
  const QueryId first = submitted_;
  last.insert(last.end(), masked_.begin(), masked_.end());
  last.insert(last.end(), blended_.begin(), blended_.end());
  submitNow(last);
  backend_.endFrame();
  return first;
}

}  // namespace sightline
