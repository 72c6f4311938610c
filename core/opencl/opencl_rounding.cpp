#include "core/opencl/opencl_rounding.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <utility>
#include <vector>

namespace sightline {
namespace {

constexpr uint32_t kPairs = 1u << 16;

/// 32 bits that look random, from a counter (finaliser of MurmurHash3).
uint32_t mixed(uint32_t i) {
  i = (i ^ (i >> 16)) * 0x85ebca6bu;
  i = (i ^ (i >> 13)) * 0xc2b2ae35u;
  return i ^ (i >> 16);
}

/// The inverse of an odd number modulo 2^32, by Newton's method: each step doubles the right bits, of which
/// the number itself has three.
uint32_t inverse(uint32_t odd) {
  uint32_t result = odd;
  for (int step = 0; step < 4; ++step) result *= 2 - odd * result;
  return result;
}

/// A pair of 24-bit integers whose quotient is next to the middle of two floats: a 2^25 = m b - rest with an
/// odd m of 25 bits and a small rest.
std::pair<float, float> hardQuotient(uint32_t i) {
  const uint32_t b = (mixed(i) >> 8) | (1u << 23) | 1u;
  const uint32_t inverse_b = inverse(b);
  for (uint32_t k = 1;; k += 2) {
    const int32_t rest = i & 1 ? int32_t(k) : -int32_t(k);
    const uint32_t m = (uint32_t(rest) * inverse_b) & ((1u << 25) - 1);
    if (m < (1u << 24)) continue;
    const int64_t a = (int64_t(m) * b - rest) >> 25;
    return {float(a), float(b)};
  }
}

/// A 24-bit integer whose root, times 2^13, is next to an odd integer of 25 bits, the middle of two floats:
/// a 2^26 = m^2 - rest with a small rest, one modulo eight, since only such are squares there.
float hardRoot(uint32_t i) {
  const int64_t rest = (int64_t(i) - kPairs / 2) * 8 + 1;
  uint64_t m = 1;
  // From m^2 = rest modulo 2^n to modulo 2^(n + 1): m or m + 2^(n - 1).
  for (int n = 3; n < 26; ++n) {
    if (((m * m - uint64_t(rest)) >> n & 1) != 0) m += uint64_t(1) << (n - 1);
  }
  m &= (1u << 25) - 1;
  if (m < (1u << 24)) m = (1u << 25) - m;
  const int64_t square = int64_t(m * m) - rest;
  return float(square >> 26);
}

/// a and b of every try, one after the other.
std::vector<float> makePairs() {
  std::vector<float> pairs;
  pairs.reserve(2 * kPairs);
  for (uint32_t i = 0; i < kPairs; ++i) {
    const uint32_t random = mixed(i + kPairs);
    // By powers of two, at most so far that all stays a float: every exponent, roots of even ones.
    const int shift = int(random % 101) - 50;
    if (i % 4 < 2) {
      const auto [a, b] = hardQuotient(i);
      pairs.insert(pairs.end(), {std::ldexp(a, shift), std::ldexp(b, int(random >> 8) % 101 - 50)});
    } else if (i % 4 == 2) {
      pairs.insert(pairs.end(), {std::ldexp(hardRoot(i), 2 * shift), std::ldexp(1.5f, shift)});
    } else {  // any positive floats, infinities aside: half of their quotients below 2^-126 or above 2^127
      pairs.push_back(std::bit_cast<float>(mixed(random) % 0x7f800000u));
      pairs.push_back(std::bit_cast<float>(mixed(~random) % 0x7f800000u));
    }
  }
  return pairs;
}

}  // namespace

bool roundsCorrectly(cl_device_id device, const char* quotient, const char* root) {
  const std::vector<float> pairs = makePairs();
  const std::string source = fmt::format(
      "__kernel void tryRounding(__global float2* pairs) {{\n"
      "  const size_t i = get_global_id(0);\n"
      "  const float a = pairs[i].x, b = pairs[i].y;\n"
      "  pairs[i] = (float2)({}, {});\n"
      "}}\n",
      quotient, root);
  OpenClContext context(device);
  context.build(source.c_str(), kClBuildOptions);
  // In place: a pair becomes its results.
  std::vector<float> results = pairs;
  const uint64_t bytes = pairs.size() * sizeof(float);
  const ClBuffer buffer = context.buffer(bytes, "numbers to try");
  context.write(buffer, pairs.data(), bytes);
  context.launch(context.kernel("tryRounding"), kPairs, 0, buffer);
  context.read(buffer, results.data(), bytes);
  for (size_t i = 0; i < pairs.size(); i += 2) {
    const float expected[] = {pairs[i] / pairs[i + 1], std::sqrt(pairs[i])};
    for (int k = 0; k < 2; ++k) {
      if (std::bit_cast<uint32_t>(results[i + k]) != std::bit_cast<uint32_t>(expected[k]) &&
          !(std::isnan(results[i + k]) && std::isnan(expected[k])))
        return false;
    }
  }
  return true;
}

}  // namespace sightline
