#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace sightline::testing_support {

/// What an iteration of a real bake found, and how long it took.
struct RecordedIteration {
  uint32_t found;
  double seconds;
};

struct RecordedBake {
  std::string name;
  std::vector<RecordedIteration> iterations;

  double seconds() const {
    double sum = 0;
    for (const RecordedIteration& iteration : iterations) sum += iteration.seconds;
    return sum;
  }
};

/// Bakes to T = 10 on the processor, as bake --csv wrote them: rooms of 12 x 12 panels a wall with gaps of 2
/// mm at 10 m between them and 30,000 (10 million random rays an iteration) and 10,000 triangles (4 million)
/// behind, and of 16 x 16 panels with gaps of 4 mm and 8,000 (2 million); a street of a generated city, a
/// rectangle and a box of a generated canyon of 400,000 triangles each (2 million). The program baked beside
/// other work, so some iterations took twice as long as others.
inline const std::vector<RecordedBake> kRecordedBakes = {
    {"hairline room",
     {{25287, 2.13}, {515, 1.55}, {343, 1.01}, {319, 1.03}, {276, 1.02}, {227, 1.02}, {180, 1.01},
      {200, 1.03},   {194, 1.02}, {147, 1.04}, {150, 1.03}, {127, 1.06}, {133, 1.03}, {122, 1.04},
      {113, 1.17},   {114, 1.04}, {97, 1.01},  {105, 1.00}, {81, 1.03},  {73, 1.74},  {80, 1.96},
      {73, 1.94},    {75, 1.96},  {62, 1.94},  {61, 2.04},  {73, 2.06},  {41, 2.01},  {46, 2.02},
      {60, 2.02},    {49, 2.00},  {52, 2.02},  {41, 2.03},  {43, 2.00},  {35, 2.00},  {46, 2.10},
      {42, 2.13},    {32, 2.04},  {37, 1.98},  {36, 2.04},  {42, 2.07},  {34, 2.36},  {26, 2.07},
      {34, 2.02},    {35, 2.04},  {19, 2.14},  {28, 1.14},  {32, 0.99},  {30, 1.03},  {35, 0.98},
      {32, 0.99},    {25, 0.99},  {16, 1.01},  {29, 1.00},  {16, 1.01},  {28, 1.00},  {18, 0.98},
      {27, 1.00},    {21, 1.02},  {19, 0.99},  {19, 0.99},  {21, 0.99},  {13, 0.99},  {13, 1.04},
      {11, 1.71},    {12, 2.00},  {19, 2.11},  {22, 1.98},  {13, 1.96},  {17, 1.99},  {12, 1.42},
      {10, 1.02},    {21, 1.02},  {19, 1.01},  {10, 1.01},  {14, 1.00},  {16, 1.02},  {9, 1.05}}},
    {"smaller hairline room",
     {{9722, 4.90}, {74, 3.57}, {50, 2.46}, {51, 2.50}, {48, 2.58}, {42, 2.51}, {37, 2.55},
      {42, 2.61},   {42, 2.55}, {33, 2.54}, {28, 2.55}, {33, 2.42}, {35, 2.54}, {29, 2.53},
      {29, 2.11},   {19, 2.12}, {32, 2.13}, {26, 2.17}, {26, 2.13}, {20, 2.13}, {29, 2.14},
      {19, 2.10},   {23, 2.20}, {20, 2.14}, {18, 2.14}, {19, 2.15}, {8, 2.29}}},
    {"wide gaps",
     {{7266, 0.59},
      {2915, 1.49},
      {23, 0.42},
      {20, 0.36},
      {13, 0.43},
      {21, 0.44},
      {15, 0.44},
      {13, 0.44},
      {19, 0.44},
      {14, 0.43},
      {16, 0.44},
      {19, 0.44},
      {14, 0.50},
      {11, 0.61},
      {6, 0.80}}},
    {"city street",
     {{97708, 5.27},
      {59068, 22.05},
      {5239, 13.91},
      {29, 1.24},
      {24, 1.26},
      {21, 1.26},
      {16, 1.28},
      {29, 1.35},
      {65, 1.19},
      {5, 1.51}}},
    {"canyon flat", {{122331, 4.43}, {4997, 0.91}, {21829, 2.56}, {126025, 6.09}, {33, 0.90}, {0, 0.87}}},
    {"canyon box", {{155084, 3.76}, {20519, 0.92}, {67914, 4.99}, {28203, 7.37}, {701, 1.28}, {4, 1.07}}},
};

}  // namespace sightline::testing_support
