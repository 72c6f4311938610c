// Halton points and random rays on lanes: this file is included once for each kind of lane. SL_UINTS and
// SL_FLOATS are the lanes' types (uint and float, or vectors of OpenCL C), SL_LANES(name) gives each kind its
// own names, SL_MUL_HIGH(a, b) is the high half of the product and SL_TO_FLOATS(x) converts numbers below
// 2^24. Scalars: halton.h.
//
// Based on: Halton, On the efficiency of certain quasi-random sequences of points in evaluating
// multi-dimensional integrals, Numerische Mathematik 2, 1960; randomised by a shift modulo 1 (Cranley and
// Patterson 1976). Point start + offset of a sequence; the index has 64 bits and never restarts, of which
// start is the remainder by the base's period. Each base keeps as many digits as a float resolves and a few
// more (2^32, 3^16, 5^12, 7^9); as the four periods are coprime, no point of the four-dimensional sequence
// repeats. Digits are reversed by halves, as bits are: short chains of dependent divisions.
SL_NAMESPACE_BEGIN

SL_FUNC SL_UINTS SL_LANES(reverseAllBits)(SL_UINTS x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
  return (x >> 16) | (x << 16);
}

SL_FUNC SL_UINTS SL_LANES(reverse4Base3)(SL_UINTS x) {
  SL_UINTS high = x / 9u;
  SL_UINTS low = x - high * 9u;
  return ((low % 3u) * 3u + low / 3u) * 9u + (high % 3u) * 3u + high / 3u;
}
SL_FUNC SL_UINTS SL_LANES(reverse8Base3)(SL_UINTS x) {
  SL_UINTS high = x / 81u;
  return SL_LANES(reverse4Base3)(x - high * 81u) * 81u + SL_LANES(reverse4Base3)(high);
}
SL_FUNC SL_UINTS SL_LANES(reverse16Base3)(SL_UINTS x) {
  SL_UINTS high = x / 6561u;
  return SL_LANES(reverse8Base3)(x - high * 6561u) * 6561u + SL_LANES(reverse8Base3)(high);
}

SL_FUNC SL_UINTS SL_LANES(reverse3Base5)(SL_UINTS x) {
  return (x % 5u) * 25u + (x / 5u % 5u) * 5u + x / 25u;
}
SL_FUNC SL_UINTS SL_LANES(reverse6Base5)(SL_UINTS x) {
  SL_UINTS high = x / 125u;
  return SL_LANES(reverse3Base5)(x - high * 125u) * 125u + SL_LANES(reverse3Base5)(high);
}
SL_FUNC SL_UINTS SL_LANES(reverse12Base5)(SL_UINTS x) {
  SL_UINTS high = x / 15625u;
  return SL_LANES(reverse6Base5)(x - high * 15625u) * 15625u + SL_LANES(reverse6Base5)(high);
}

SL_FUNC SL_UINTS SL_LANES(reverse3Base7)(SL_UINTS x) {
  return (x % 7u) * 49u + (x / 7u % 7u) * 7u + x / 49u;
}
SL_FUNC SL_UINTS SL_LANES(reverse9Base7)(SL_UINTS x) {
  SL_UINTS middle = x / 343u;
  SL_UINTS high = middle / 343u;
  return (SL_LANES(reverse3Base7)(x - middle * 343u) * 343u + SL_LANES(reverse3Base7)(middle - high * 343u)) *
             343u +
         SL_LANES(reverse3Base7)(high);
}

/// a + b modulo period, for a and b below it.
SL_FUNC SL_UINTS SL_LANES(addModulo)(SL_UINTS a, uint b, uint period) {
  return a >= period - b ? a - (period - b) : a + b;
}

/// Point start + offset of the base's sequence, shifted: floor(fraction * 2^24), in rare cases one less.
/// start and shift are below the period.
SL_FUNC SL_UINTS SL_LANES(haltonPoint2)(uint start, SL_UINTS offset, uint shift) {
  return (SL_LANES(reverseAllBits)(offset + start) + shift) >> 8;
}
SL_FUNC SL_UINTS SL_LANES(haltonPoint3)(uint start, SL_UINTS offset, uint shift) {
  SL_UINTS index = SL_LANES(addModulo)(offset % kHaltonPeriod3, start, kHaltonPeriod3);
  return SL_MUL_HIGH(SL_LANES(addModulo)(SL_LANES(reverse16Base3)(index), shift, kHaltonPeriod3),
                     1673939207u);  // 2^56 / 3^16
}
SL_FUNC SL_UINTS SL_LANES(haltonPoint5)(uint start, SL_UINTS offset, uint shift) {
  SL_UINTS index = SL_LANES(addModulo)(offset % kHaltonPeriod5, start, kHaltonPeriod5);
  return SL_MUL_HIGH(SL_LANES(addModulo)(SL_LANES(reverse12Base5)(index), shift, kHaltonPeriod5),
                     295147905u);  // 2^56 / 5^12
}
SL_FUNC SL_UINTS SL_LANES(haltonPoint7)(uint start, SL_UINTS offset, uint shift) {
  SL_UINTS index = SL_LANES(addModulo)(offset % kHaltonPeriod7, start, kHaltonPeriod7);
  return SL_MUL_HIGH(SL_LANES(addModulo)(SL_LANES(reverse9Base7)(index), shift, kHaltonPeriod7),
                     1785654353u);  // 2^56 / 7^9
}

/// The fraction of a number of 24 bits as a float in [0, 1), exactly.
SL_FUNC SL_FLOATS SL_LANES(haltonFraction)(SL_UINTS fixed24) {
  return SL_TO_FLOATS(fixed24) * 5.9604644775390625e-8f;
}

/// sin(x * pi / 2) for x in [0, 1], error below 3e-7: Taylor polynomial of degree 11. The runtimes' own sines
/// differ from each other.
SL_FUNC SL_FLOATS SL_LANES(sinQuarter)(SL_FLOATS x) {
  SL_FLOATS x2 = x * x;
  SL_FLOATS p = x2 * -3.5988432e-6f + 1.6044118e-4f;
  p = p * x2 + -4.6817541e-3f;
  p = p * x2 + 7.9692626e-2f;
  p = p * x2 + -6.4596410e-1f;
  p = p * x2 + 1.5707963f;
  return min(p * x, 1.0f);
}

/// Components of unit directions in a face's frame: x along axis_u, y along axis_v, z > 0 along the normal.
SL_STRUCT(SL_LANES(HemisphereDirection)) {
  SL_FLOATS x;
  SL_FLOATS y;
  SL_FLOATS z;
};

/// Uniform over the hemisphere for numbers of 24 bits (equation 5.3 with z = 1 - h), but for directions that
/// rise by less than 2^-18: those rise by that, so that rounding turns none of them into the cell (look.h).
SL_FUNC SL_LANES(HemisphereDirection) SL_LANES(hemisphereDirection)(SL_UINTS azimuth24, SL_UINTS height24) {
  SL_UINTS quadrant = azimuth24 >> 22;
  SL_UINTS odd = quadrant & 1u;
  SL_FLOATS within = SL_TO_FLOATS(azimuth24 & 0x3fffffu) * 2.384185791015625e-7f;  // exact, [0, 1)
  SL_FLOATS s = SL_LANES(sinQuarter)(within);
  SL_FLOATS c = SL_LANES(sinQuarter)(1.0f - within);
  SL_UINTS highest = 0xffffc0u;  // of SL_UINTS: Oclgrind misreads the scalar of min(uint8, uint)
  SL_FLOATS height = SL_LANES(haltonFraction)(min(height24, highest));
  SL_LANES(HemisphereDirection) direction;
  direction.z = 1.0f - height;
  SL_FLOATS r = sqrt(height * (1.0f + direction.z));
  SL_FLOATS x = odd == 0u ? c : s;
  SL_FLOATS y = odd == 0u ? s : c;
  x = ((quadrant + 1u) & 2u) != 0u ? -x : x;
  y = quadrant >= 2u ? -y : y;
  direction.x = r * x;
  direction.y = r * y;
  return direction;
}

/// Rays, a lane each.
SL_STRUCT(SL_LANES(RandomRays)) {
  SL_FLOATS origin_x;
  SL_FLOATS origin_y;
  SL_FLOATS origin_z;
  SL_FLOATS direction_x;
  SL_FLOATS direction_y;
  SL_FLOATS direction_z;
};

/// The rays of points first + offset of the sequences: bases 2 and 3 give the direction, 5 and 7 the origin
/// on the face. shifts: StageParams::shifts.
SL_FUNC SL_LANES(RandomRays) SL_LANES(randomRays)(uint64 first, SL_UINTS offset, Face face, uvec4 shifts) {
  SL_LANES(HemisphereDirection)
  framed =
      SL_LANES(hemisphereDirection)(SL_LANES(haltonPoint2)(slUint(first), offset, shifts.x),
                                    SL_LANES(haltonPoint3)(slUint(first % kHaltonPeriod3), offset, shifts.y));
  SL_FLOATS u =
      SL_LANES(haltonFraction)(SL_LANES(haltonPoint5)(slUint(first % kHaltonPeriod5), offset, shifts.z));
  SL_FLOATS v =
      SL_LANES(haltonFraction)(SL_LANES(haltonPoint7)(slUint(first % kHaltonPeriod7), offset, shifts.w));
  SL_LANES(RandomRays) rays;
  rays.origin_x = (u * face.edge_u.x + face.corner.x) + v * face.edge_v.x;
  rays.origin_y = (u * face.edge_u.y + face.corner.y) + v * face.edge_v.y;
  rays.origin_z = (u * face.edge_u.z + face.corner.z) + v * face.edge_v.z;
  rays.direction_x = (framed.x * face.axis_u.x + framed.y * face.axis_v.x) + framed.z * face.normal.x;
  rays.direction_y = (framed.x * face.axis_u.y + framed.y * face.axis_v.y) + framed.z * face.normal.y;
  rays.direction_z = (framed.x * face.axis_u.z + framed.y * face.axis_v.z) + framed.z * face.normal.z;
  return rays;
}

SL_NAMESPACE_END
