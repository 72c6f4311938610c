#include <gtest/gtest.h>

#include "core/shared/border.h"
#include "core/shared/camera.h"
#include "core/shared/reverse.h"
#include "core/shared/stage_params.h"
#include "core/shared/view_ray.h"

namespace sightline {
namespace {

TEST(Layout, StructsInBuffersHaveTheSizesOfAllThreeLanguages) {
  EXPECT_EQ(sizeof(Ray), 32u);
  EXPECT_EQ(sizeof(Hit), 8u);
  EXPECT_EQ(sizeof(Face), 96u);
  EXPECT_EQ(sizeof(PvsEntry), 32u);
  EXPECT_EQ(sizeof(StageParams), 96u);
  EXPECT_EQ(sizeof(RandomSegment), 64u);
  EXPECT_EQ(sizeof(ViewFrame), 64u);
  EXPECT_EQ(sizeof(Camera), 80u);
  EXPECT_EQ(sizeof(BorderEdge), 48u);
  EXPECT_EQ(sizeof(Discontinuity), 16u);
  EXPECT_EQ(sizeof(ReverseItem), 80u);
}

}  // namespace
}  // namespace sightline
