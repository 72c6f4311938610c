// Sums and products without rounding error, kept as pairs of floats: the stand-in for double on devices
// that have none. Needs round-to-nearest, no contraction and products that neither overflow nor fall
// below 2^-100 (smaller parts are lost, as in any float arithmetic).
// Based on: Dekker, A floating-point technique for extending the available precision, 1971; Knuth, TAOCP 2.
#ifndef SL_TWO_FLOAT_H
#define SL_TWO_FLOAT_H
#include "core/shared/language.h"
SL_NAMESPACE_BEGIN

/// The value high + low, |low| at most half a unit in the last place of high.
SL_STRUCT(TwoFloat) {
  float high;
  float low;
};

/// a + b, exactly.
SL_FUNC TwoFloat twoSum(float a, float b) {
  TwoFloat result;
  result.high = a + b;
  float b_part = result.high - a;
  float a_part = result.high - b_part;
  result.low = (a - a_part) + (b - b_part);
  return result;
}

/// a * b, exactly (Veltkamp's split: 12 bits a half; |a|, |b| < 2^114).
SL_FUNC TwoFloat twoProduct(float a, float b) {
  float a_shifted = a * 4097.0f;
  float a_high = a_shifted - (a_shifted - a);
  float a_low = a - a_high;
  float b_shifted = b * 4097.0f;
  float b_high = b_shifted - (b_shifted - b);
  float b_low = b - b_high;
  TwoFloat result;
  result.high = a * b;
  result.low = ((a_high * b_high - result.high) + a_high * b_low + a_low * b_high) + a_low * b_low;
  return result;
}

/// a + b to about 46 bits.
SL_FUNC TwoFloat addTwoFloats(TwoFloat a, TwoFloat b) {
  TwoFloat high = twoSum(a.high, b.high);
  TwoFloat low = twoSum(a.low, b.low);
  TwoFloat middle = twoSum(high.high, low.high);
  return twoSum(middle.high, (middle.low + high.low) + low.low);
}

/// a * b - c * d to about 46 bits; zero and sign are exact.
SL_FUNC TwoFloat differenceOfProducts(float a, float b, float c, float d) {
  TwoFloat subtrahend = twoProduct(c, d);
  subtrahend.high = -subtrahend.high;
  subtrahend.low = -subtrahend.low;
  return addTwoFloats(twoProduct(a, b), subtrahend);
}

/// a * b to about 45 bits.
SL_FUNC TwoFloat scaleTwoFloat(TwoFloat a, float b) {
  TwoFloat product = twoProduct(a.high, b);
  return twoSum(product.high, product.low + a.low * b);
}

/// a / b, rounded to float; the last bit may differ from the rounded exact quotient in about one of 2^20.
SL_FUNC float divideTwoFloats(TwoFloat a, TwoFloat b) {
  float quotient = slDivide(a.high, b.high);
  TwoFloat part = scaleTwoFloat(b, -quotient);
  TwoFloat rest = addTwoFloats(a, part);
  return quotient + slDivide(rest.high, b.high);
}

SL_NAMESPACE_END
#endif
