#include "core/draw/multi_query.h"

#include "core/base/portable_math.h"

namespace sightline {

double stillHidden(uint32_t hidden_frames) {
  return 0.99 - 0.7 * portableExp(-double(hidden_frames));
}

double multiQueryValue(uint32_t count, double all_hidden) {
  return count == 1 ? 1.0 : count / (1 + (1 - all_hidden) * count);
}

uint32_t multiQuerySize(std::span<const double> hidden) {
  uint32_t best = 1;
  double best_value = 1, all_hidden = 1;
  for (uint32_t count = 1; count <= hidden.size(); ++count) {
    all_hidden *= hidden[count - 1];
    // However many more there are, the value stays below 1 / (1 - all_hidden).
    if (best_value * (1 - all_hidden) >= 1) break;
    const double value = multiQueryValue(count, all_hidden);
    if (value > best_value) {
      best = count;
      best_value = value;
    }
  }
  return best;
}

}  // namespace sightline
