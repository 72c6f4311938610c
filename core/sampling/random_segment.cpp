#include "core/sampling/random_segment.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/shared/random_ray.h"

namespace sightline {
namespace {

/// Rays that a stratum should hold at least: two packets of eight, so that few slots stay empty (1 in 16 at
/// most). Measured on PoCL, city of 2 million triangles, Mrays/s: 8 rays 18.1, 16 rays 18.6, 64 rays 16.2.
constexpr double kRaysPerStratum = 16;
/// Cells along u and v of the face in which a direction's rays are grouped: 5^1 by 7^1. At equal rays a
/// stratum, Mrays/s: 1 cell 14.6, 5 cells 16.6, 7 cells 17.2, 35 cells 18.6, 175 cells 16.6.
constexpr uint32_t kOriginDigits5 = 1, kOriginDigits7 = 1;
constexpr double kOriginCells = 35;

/// Inverse of a modulo m (a and m coprime) by the extended Euclidean algorithm; 0 for m = 1.
uint64_t inverseModulo(uint64_t a, uint64_t m) {
  int64_t t = 0, next_t = 1;
  int64_t r = static_cast<int64_t>(m), next_r = static_cast<int64_t>(a % m);
  while (next_r != 0) {
    const int64_t quotient = r / next_r;
    t = std::exchange(next_t, t - quotient * next_t);
    r = std::exchange(next_r, r - quotient * next_r);
  }
  return static_cast<uint64_t>(t < 0 ? t + static_cast<int64_t>(m) : t) % m;
}

/// c with c = 1 modulo `modulus` and c = 0 modulo strata / modulus.
uint32_t remainderCoefficient(uint64_t strata, uint64_t modulus) {
  const uint64_t others = strata / modulus;
  return static_cast<uint32_t>(others * inverseModulo(others, modulus) % strata);
}

}  // namespace

RandomSegment makeRandomSegment(uint32_t face, uint64_t first, uint32_t count, uint32_t first_ray_index) {
  RandomSegment segment{};
  segment.range = uvec4(face, static_cast<uint32_t>(first), static_cast<uint32_t>(first >> 32), count);

  // Directions: as many azimuths as heights seen from afar, 2^a : 3^b about 4 : 1 (2 pi by 1 on the sphere's
  // cylinder projection, of which azimuths shrink towards the pole).
  const double strata_wanted = count / kRaysPerStratum;
  const bool split_origins = strata_wanted >= 8 * kOriginCells;
  const double directions = split_origins ? strata_wanted / kOriginCells : strata_wanted;
  uint32_t a = 0, b = 0;
  while (double(power(2, a + 1)) * power(3, b) <= directions) {
    if (double(power(2, a)) > 4.0 * power(3, b) && double(power(2, a)) * power(3, b + 1) <= directions) {
      ++b;
    } else {
      ++a;
    }
  }
  segment.digits = uvec4(a, b, split_origins ? kOriginDigits5 : 0, split_origins ? kOriginDigits7 : 0);

  const uint64_t m2 = power(2, a), m3 = power(3, b);
  const uint64_t m5 = power(5, segment.digits.z), m7 = power(7, segment.digits.w);
  const uint64_t strata = m2 * m3 * m5 * m7;
  segment.batch =
      uvec4(first_ray_index, static_cast<uint32_t>(strata),
            static_cast<uint32_t>((count + strata - 1) / strata), static_cast<uint32_t>(first % strata));
  segment.coefficients = uvec4(remainderCoefficient(strata, m2), remainderCoefficient(strata, m3),
                               remainderCoefficient(strata, m5), remainderCoefficient(strata, m7));
  return segment;
}

}  // namespace sightline
