// Sets of cells as what is drawn in them.
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/cell/cell_contains.h"
#include "core/draw/cull_pvs.h"
#include "core/draw/optimal_counts.h"
#include "tests/draw/draw_cases.h"
#include "tests/support/random_triangles.h"

namespace sightline {
namespace {

using draw_cases::cameraAt;

CellPvs cellOf(glm::dvec3 center, glm::dvec3 size, std::vector<uint32_t> ids) {
  CellPvs cell;
  cell.cell.center = center;
  cell.cell.size = size;
  cell.triangles = std::move(ids);
  return cell;
}

struct City {
  Scene scene = generateScene("city", 5000, 1);
  DrawScene parts = makeDrawScene(scene, {.split = 100});
  PvsFile pvs;

  City() {
    testing_support::Random random(1);
    for (int c = 0; c < 40; ++c) {
      std::vector<uint32_t> ids;
      for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
        if (random.pick(40) == 0) ids.push_back(id);
      }
      pvs.cells.push_back(
          cellOf(glm::dvec3(random.point(20)), glm::dvec3(5) + glm::abs(glm::dvec3(random.point(25))), ids));
      pvs.cells.back().cell.rotation = glm::dvec3(0, 90 * random.unit(), 0);
    }
  }
};

TEST(PvsUnits, AreTheSets) {
  City city;
  for (uint32_t id = 0; id < city.scene.triangleCount(); ++id) {
    city.scene.surfaces.words.push_back(id % 7 == 1 ? kSurfaceGlass : id % 7 == 2 ? kSurfaceMasked : 0);
  }
  const Drawables drawables = partitionScene(city.scene, {.split = 50});
  OpenSet open;
  open.triangles = {5, 8, 4000};
  std::erase_if(city.pvs.cells[1].triangles, [](uint32_t id) { return id == 5 || id == 8 || id == 4000; });
  city.pvs.cells[1].open = open;
  for (const bool doors : {false, true}) {
    const PvsUnits units = makePvsUnits(city.pvs, drawables, doors);
    ASSERT_EQ(units.cells.size(), 40u);
    for (size_t c = 0; c < 40; ++c) {
      std::set<uint32_t> ids(city.pvs.cells[c].triangles.begin(), city.pvs.cells[c].triangles.end());
      if (doors && c == 1) ids.insert({5, 8, 4000});
      std::set<uint32_t> seen;
      for (uint32_t d = 0; d < drawables.list.size(); ++d) {
        const auto of = drawables.trianglesOf(d);
        if (std::ranges::any_of(of, [&](uint32_t id) { return ids.contains(id); })) seen.insert(d);
      }
      EXPECT_EQ(std::vector<uint32_t>(seen.begin(), seen.end()), units.drawables[c]);
      const TriangleList& list = units.triangles.lists[c];
      EXPECT_EQ(std::set<uint32_t>(list.ids.begin(), list.ids.end()), ids);
      EXPECT_EQ(list.ids.size(), ids.size());
      EXPECT_EQ(list.draws(), 3u);
      for (uint32_t i = 0; i < list.ids.size(); ++i) {
        const uint32_t word = city.scene.surfaces.words[list.ids[i]];
        EXPECT_EQ(i >= list.masked_begin && i < list.blended_begin, word == kSurfaceMasked);
        EXPECT_EQ(i >= list.blended_begin, word == kSurfaceGlass);
        if (i > 0 && i != list.masked_begin && i != list.blended_begin) {
          EXPECT_LT(list.ids[i - 1], list.ids[i]);
        }
      }
    }
  }
}

TEST(PvsUnits, CellsAreFoundAsBruteForceDoes) {
  const City city;
  const PvsUnits units = makePvsUnits(city.pvs, city.parts.drawables);
  testing_support::Random random(2);
  std::optional<uint32_t> last;
  int stayed = 0, outside = 0;
  glm::dvec3 place(0);
  for (int i = 0; i < 5000; ++i) {
    place = i % 50 == 0 ? glm::dvec3(random.point(25)) : place + glm::dvec3(random.point(0.5f));
    std::optional<uint32_t> best;
    for (uint32_t c = 0; c < 40; ++c) {
      if (!cellContains(units.cells[c], place)) continue;
      if (!best || city.pvs.cells[c].triangles.size() < city.pvs.cells[*best].triangles.size()) best = c;
    }
    EXPECT_EQ(units.cellAt(place), best);
    const auto found = units.cellAt(place, last);
    EXPECT_EQ(found.has_value(), best.has_value());
    if (last && cellContains(units.cells[*last], place)) {
      EXPECT_EQ(found, last);
      stayed += found != best;
    } else {
      EXPECT_EQ(found, best);
    }
    outside += !found;
    last = found;
  }
  EXPECT_GT(stayed, 50);
  EXPECT_GT(outside, 50);
  EXPECT_FALSE(units.cellAt({NAN, 0, 0}));
  EXPECT_EQ(units.cellAt(glm::dvec3(1000), 3u), std::nullopt);
}

TEST(PvsUnits, NearestCellIsNearest) {
  PvsFile pvs;
  pvs.cells = {cellOf({0, 0, 0}, {2, 2, 2}, {}), cellOf({10, 0, 0}, {2, 2, 2}, {}),
               cellOf({10, 0, 0}, {2, 2, 2}, {})};
  pvs.cells[1].cell.rotation = {0, 45, 0};  // its corner is nearer than that of the third
  const PvsUnits units = makePvsUnits(pvs, {});
  EXPECT_EQ(units.nearestCell({4.7, 0, 0}), 0u);
  EXPECT_EQ(units.nearestCell({4.9, 0, 0}), 1u);
  EXPECT_EQ(units.nearestCell({10, 3, 0}), 1u);  // as near: the first
  EXPECT_EQ(units.nearestCell({11.2, 0, 1.2}), 2u);
  EXPECT_EQ(PvsUnits{}.nearestCell({0, 0, 0}), std::nullopt);
}

TEST(CullPvs, DrawsTheCellOfTheCamera) {
  City city;
  // A cell that knows all that is seen, one that knows nothing.
  const Camera camera = draw_cases::cityWalk(city.parts, 10, 64, 48)[1];
  const glm::dvec3 eye(camera.eye);
  std::vector<uint32_t> all(city.scene.triangleCount());
  for (uint32_t id = 0; id < all.size(); ++id) all[id] = id;
  city.pvs.cells = {cellOf(eye, {1, 1, 1}, all), cellOf(eye + 50.0, {1, 1, 1}, {3, 4})};
  const PvsUnits units = makePvsUnits(city.pvs, city.parts.drawables);
  const draw_cases::Truth truth = draw_cases::bruteForce(city.scene, city.parts, camera);
  for (const bool list : {true, false}) {
    const auto make = [&](OutsideCells outside) {
      return list ? cullPvsList(city.parts, units, {outside}) : cullPvsFrustum(city.parts, units, {outside});
    };
    SoftwareBackend backend(city.scene, city.parts.drawables, &units.triangles);
    std::vector<uint32_t> drawn;
    const FrameCounts in = make(OutsideCells::error)->drawFrame(camera, 0, backend, drawn);
    EXPECT_FALSE(draw_cases::compare(truth, backend.image(), drawn).any());
    EXPECT_FALSE(in.outside);
    EXPECT_EQ(in.submits, 1u);
    if (list) {
      EXPECT_EQ(in.triangles, all.size());
      EXPECT_EQ(in.draws, 1u);
      EXPECT_EQ(in.objects, city.parts.drawables.list.size());
    } else {
      EXPECT_LT(in.triangles, all.size());
      EXPECT_EQ(in.draws, in.objects);
    }
    // Outside of both cells, nearer to the second.
    Camera away = camera;
    away.eye = vec4(vec3(eye + 40.0), camera.eye.w);
    EXPECT_TRUE(make(OutsideCells::all)->drawFrame(away, 0, backend, drawn).outside);
    const draw_cases::Truth far = draw_cases::bruteForce(city.scene, city.parts, away);
    EXPECT_FALSE(draw_cases::compare(far, backend.image(), drawn).any());
    const FrameCounts nearest = make(OutsideCells::nearest)->drawFrame(away, 0, backend, drawn);
    EXPECT_TRUE(nearest.outside);
    EXPECT_LE(drawn.size(), 2u);
    // Of a cell that is named, wherever the camera is.
    const std::vector<uint32_t> cells = {1, 0};
    const CellChoice named{OutsideCells::error, cells};
    const auto by_frame =
        list ? cullPvsList(city.parts, units, named) : cullPvsFrustum(city.parts, units, named);
    EXPECT_FALSE(by_frame->drawFrame(camera, 1, backend, drawn).outside);
    EXPECT_FALSE(draw_cases::compare(truth, backend.image(), drawn).any());
    EXPECT_FALSE(by_frame->drawFrame(camera, 0, backend, drawn).outside);
    EXPECT_LE(drawn.size(), 2u);
    try {
      make(OutsideCells::error)->drawFrame(away, 17, backend, drawn);
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("frame 17: the camera at "), std::string::npos)
          << error.what();
    }
  }
}

TEST(OptimalCounts, AreThoseOfTheIds) {
  const City city;
  const Camera camera = draw_cases::cityWalk(city.parts, 10, 64, 48)[1];
  SoftwareImage image(city.scene);
  image.begin(camera);
  for (uint32_t id = 0; id < city.scene.triangleCount(); ++id) image.draw(id);
  const auto owner = drawableOfTriangles(city.parts.drawables);
  std::vector<uint32_t> sizes;
  for (const Drawable& d : city.parts.drawables.list) sizes.push_back(d.triangle_count);
  std::set<uint32_t> ids(image.ids().begin(), image.ids().end()), drawables;
  ids.erase(kNoTriangle);
  uint64_t triangles = 0;
  for (const uint32_t id : ids) {
    if (drawables.insert(owner[id]).second) triangles += sizes[owner[id]];
  }
  const OptimalCounts counts = countOptimal(image.ids(), owner, sizes);
  EXPECT_EQ(counts, (OptimalCounts{drawables.size(), ids.size(), triangles}));
  EXPECT_GT(counts.triangles, 50u);
  EXPECT_EQ(countOptimal(std::vector<uint32_t>(9, kNoTriangle), owner, sizes), OptimalCounts{});
}

}  // namespace
}  // namespace sightline
