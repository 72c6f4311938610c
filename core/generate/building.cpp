#include "core/generate/building.h"

#include <algorithm>

#include "core/generate/generator_random.h"
#include "core/generate/rim.h"

namespace sightline {
namespace {

/// What a building looks like, whatever the level.
struct Style {
  float window_pitch, window_width, window_low, window_high;  // pitch in metres, rest as shares of the cell
  float recess;
  bool gable, balconies, shutters, setback;
  uint32_t balcony_every;
};

Style drawStyle(GeneratorRandom& random, const BuildingSpec& spec) {
  Style s{};
  s.window_pitch = random.uniform(2.3f, 3.8f);
  s.window_width = random.uniform(0.4f, 0.62f);
  s.window_low = random.uniform(0.12f, 0.32f);
  s.window_high = random.uniform(0.78f, 0.88f);
  s.recess = random.uniform(0.12f, 0.3f);
  s.gable = spec.floors <= 6 && random.chance(0.45f);
  s.balconies = random.chance(0.6f);
  s.shutters = random.chance(0.55f);
  s.setback = spec.floors >= 9 && random.chance(0.7f);
  s.balcony_every = 2 + random.below(3);
  return s;
}

/// Which details a facade has at a level.
struct Details {
  bool bands, windows, sills, lintels, mullions, frames, cornices;
  uint32_t bars;   // of a balcony's railing, a metre; 0: no balconies
  uint32_t slats;  // of a shutter; 0: no shutters
};

Details detailsAt(uint32_t level, bool street, const Style& style) {
  Details d{};
  d.bands = level >= (street ? 1 : 2);
  d.windows = level >= (street ? 3 : 4);
  d.cornices = level >= 5;
  d.sills = level >= (street ? 6 : 8);
  d.mullions = level >= (street ? 7 : 12);
  d.lintels = level >= (street ? 8 : 13);
  d.frames = level >= (street ? 9 : 15);
  if (street && style.balconies && level >= 10) d.bars = 3 + (level - 10) / 2;
  if (street && style.shutters && level >= 11) d.slats = 6 + 2 * (level - 11);
  return d;
}

/// A rectangle of the wall, in the facade's frame.
struct Cell {
  float x0, y0, x1, y1;
};

/// Wall with a recessed pane. corners: its four outer vertices, counter-clockwise from low x and y.
void recessedPane(MeshBuilder& mesh, const uint32_t (&corners)[4], Cell hole, float recess) {
  const uint32_t rim = uint32_t(mesh.vertexCount());
  for (const float z : {0.0f, -recess}) {
    mesh.vertex({hole.x0, hole.y0, z});
    mesh.vertex({hole.x1, hole.y0, z});
    mesh.vertex({hole.x1, hole.y1, z});
    mesh.vertex({hole.x0, hole.y1, z});
  }
  for (uint32_t i = 0; i < 4; ++i) {
    const uint32_t j = (i + 1) & 3;
    mesh.quad(corners[i], corners[j], rim + j, rim + i);
    mesh.quad(rim + i, rim + j, rim + 4 + j, rim + 4 + i);
  }
  mesh.use(Matter::kPane);
  mesh.quad(rim + 4, rim + 5, rim + 6, rim + 7);
  mesh.use(Matter::kSolid);
}

void windowFrame(MeshBuilder& mesh, Cell h, float recess) {
  const float w = 0.06f, z0 = -recess, z1 = -recess + 0.05f;
  mesh.box({h.x0, h.y0, z0}, {h.x0 + w, h.y1, z1}, kNoLowZ);
  mesh.box({h.x1 - w, h.y0, z0}, {h.x1, h.y1, z1}, kNoLowZ);
  mesh.box({h.x0 + w, h.y0, z0}, {h.x1 - w, h.y0 + w, z1}, kNoLowZ);
  mesh.box({h.x0 + w, h.y1 - w, z0}, {h.x1 - w, h.y1, z1}, kNoLowZ);
}

void mullions(MeshBuilder& mesh, Cell h, float recess) {
  const float z0 = -recess, z1 = -recess + 0.04f, x = (h.x0 + h.x1) / 2, y = h.y0 + (h.y1 - h.y0) * 0.65f;
  mesh.box({x - 0.025f, h.y0, z0}, {x + 0.025f, h.y1, z1}, kNoLowZ);
  mesh.box({h.x0, y - 0.025f, z0}, {x - 0.025f, y + 0.025f, z1}, kNoLowZ);
  mesh.box({x + 0.025f, y - 0.025f, z0}, {h.x1, y + 0.025f, z1}, kNoLowZ);
}

/// Open shutters on both sides of a window: a frame's two stiles and tilted slats.
void shutters(MeshBuilder& mesh, Cell h, uint32_t slats, float room) {
  const float width = std::min((h.x1 - h.x0) * 0.5f, room * 0.9f);
  if (width < 0.1f) return;
  const float rise = (h.y1 - h.y0) / float(slats), stile = width * 0.08f;
  for (const float x0 : {h.x0 - width - 0.01f, h.x1 + 0.01f}) {
    mesh.box({x0, h.y0, 0.005f}, {x0 + stile, h.y1, 0.045f});
    mesh.box({x0 + width - stile, h.y0, 0.005f}, {x0 + width, h.y1, 0.045f});
    const float a = x0 + stile, b = x0 + width - stile;
    for (uint32_t i = 0; i < slats; ++i) {
      const float y = h.y0 + rise * float(i), top = y + rise * 0.9f;
      if (mesh.closed()) {
        mesh.board({{{a, y, 0.04f}, {b, y, 0.04f}, {b, top, 0.01f}, {a, top, 0.01f}}}, {0, 0, -0.004f});
        continue;
      }
      mesh.quad({a, y, 0.04f}, {b, y, 0.04f}, {b, top, 0.01f}, {a, top, 0.01f});
    }
  }
}

void balcony(MeshBuilder& mesh, Cell c, float floor_y, uint32_t bars_a_metre) {
  const float out = 1.1f, x0 = c.x0 + 0.1f, x1 = c.x1 - 0.1f, top = floor_y + 1.0f;
  mesh.box({x0, floor_y - 0.15f, 0}, {x1, floor_y, out}, kNoLowZ);
  mesh.box({x0, top - 0.04f, out - 0.06f}, {x1, top, out - 0.02f});
  const uint32_t bars = std::max(2u, uint32_t((x1 - x0) * float(bars_a_metre)));
  const auto bar = [&](float x, float z) {
    mesh.box({x - 0.01f, floor_y, z - 0.01f}, {x + 0.01f, top - 0.04f, z + 0.01f}, kNoLowY | kNoHighY);
  };
  for (uint32_t i = 0; i < bars; ++i) {
    bar(x0 + 0.02f + (x1 - x0 - 0.04f) * (float(i) + 0.5f) / float(bars), out - 0.04f);
  }
  for (const float x : {x0 + 0.02f, x1 - 0.02f}) {
    mesh.box({x - 0.02f, top - 0.04f, 0}, {x + 0.02f, top, out - 0.06f}, kNoLowZ);
    const uint32_t side_bars = std::max(1u, bars_a_metre);
    for (uint32_t i = 0; i < side_bars; ++i) bar(x, (out - 0.1f) * (float(i) + 0.5f) / float(side_bars));
  }
}

struct Facade {
  float width, height;
  uint32_t floors;
  bool street;
  bool ground_floor;  // its lowest floor has doors and shop windows
};

void windowExtras(MeshBuilder& mesh, const Details& d, Cell cell, Cell hole, float recess) {
  const float wall = (cell.x1 - cell.x0 - (hole.x1 - hole.x0)) / 2;
  if (d.sills) {
    mesh.box({hole.x0 - 0.08f, hole.y0 - 0.08f, 0}, {hole.x1 + 0.08f, hole.y0 - 0.01f, 0.14f}, kNoLowZ);
  }
  if (d.lintels) {
    mesh.box({hole.x0 - 0.12f, hole.y1 + 0.01f, 0}, {hole.x1 + 0.12f, hole.y1 + 0.13f, 0.1f}, kNoLowZ);
  }
  if (d.mullions)
    mullions(mesh, d.frames ? Cell{hole.x0 + 0.06f, hole.y0 + 0.06f, hole.x1 - 0.06f, hole.y1 - 0.06f} : hole,
             recess);
  if (d.frames) windowFrame(mesh, hole, recess);
  if (d.slats > 0) shutters(mesh, hole, d.slats, wall);
}

/// Of a facade that is a part of a solid: it ends in vertices that the facades beside it share, from below
/// up, and says in which it ends below and above, from the left to the right.
struct FacadeSeams {
  const Seam &left, &right;
  Seam &bottom, &top;
};

/// seams: where the facade is a part of a solid.
void facade(MeshBuilder& mesh, const Facade& f, const Style& style, uint32_t level,
            const FacadeSeams* seams = nullptr) {
  const Details d = detailsAt(level, f.street, style);
  if (!d.bands && seams != nullptr) {
    closeBetween(mesh, seams->left, seams->right);
    seams->bottom = {seams->left.front(), seams->right.front()};
    seams->top = {seams->left.back(), seams->right.back()};
    return;
  }
  if (!d.bands) {
    mesh.quad({0, 0, 0}, {f.width, 0, 0}, {f.width, f.height, 0}, {0, f.height, 0});
    return;
  }
  const float pitch = style.window_pitch * (f.street ? 1.0f : 1.7f);
  const uint32_t columns = d.windows ? std::max(1u, uint32_t(f.width / pitch)) : 1;
  const float cw = f.width / float(columns), ch = f.height / float(f.floors);
  std::vector<uint32_t> grid;
  for (uint32_t j = 0; j <= f.floors; ++j) {
    for (uint32_t i = 0; i <= columns; ++i) {
      const bool shared = seams != nullptr && (i == 0 || i == columns);
      grid.push_back(shared ? (i == 0 ? seams->left : seams->right)[j]
                            : mesh.vertex({cw * float(i), ch * float(j), 0}));
    }
  }
  if (seams != nullptr) {
    seams->bottom.assign(grid.begin(), grid.begin() + columns + 1);
    seams->top.assign(grid.end() - columns - 1, grid.end());
  }
  const float margin = d.windows ? (1 - style.window_width) / 2 : 0.06f;
  for (uint32_t j = 0; j < f.floors; ++j) {
    for (uint32_t i = 0; i < columns; ++i) {
      const Cell cell{cw * float(i), ch * float(j), cw * float(i + 1), ch * float(j + 1)};
      const bool shop = f.ground_floor && j == 0 && f.street;
      const float side = cw * (shop ? margin * 0.5f : margin);
      const Cell hole{cell.x0 + side, cell.y0 + ch * (shop ? 0.04f : style.window_low), cell.x1 - side,
                      cell.y0 + ch * style.window_high};
      const uint32_t* a = &grid[j * (columns + 1) + i];
      const uint32_t corners[4] = {a[0], a[1], a[columns + 2], a[columns + 1]};
      recessedPane(mesh, corners, hole, style.recess);
      if (!d.windows) continue;
      Details own = d;
      const bool with_balcony = d.bars > 0 && j > 0 && i % style.balcony_every == 0;
      if (shop) own.sills = false, own.slats = 0;
      if (with_balcony) own.sills = false;
      windowExtras(mesh, own, cell, hole, style.recess);
      if (with_balcony) balcony(mesh, cell, cell.y0 + 0.16f, d.bars);
    }
    if (d.cornices && f.street && (j == 0 || j + 1 == f.floors)) {
      const float y = ch * float(j + 1);
      mesh.box({0, y - 0.14f, 0}, {f.width, y, j == 0 ? 0.12f : 0.3f}, kNoLowZ);
    }
  }
}

/// What shows through panes: the floors, clear of them.
void slabs(MeshBuilder& mesh, float w, float d, float floor_height, uint32_t floors, const Style& style) {
  const float in = style.recess + 0.05f;
  for (uint32_t j = 0; j < floors; ++j) {
    const float y = floor_height * float(j) + 0.02f;
    mesh.quad({in, y, d - in}, {w - in, y, d - in}, {w - in, y, in}, {in, y, in});
  }
}

/// Four facades about [0, w] x [0, d] from y = 0 up.
void walls(MeshBuilder& mesh, const BuildingSpec& spec, float w, float d, uint32_t floors, bool ground_floor,
           const Style& style, uint32_t level) {
  const Frame base = mesh.frame;
  const glm::vec3 starts[4] = {{0, 0, d}, {w, 0, d}, {w, 0, 0}, {0, 0, 0}};
  for (uint32_t side = 0; side < 4; ++side) {
    mesh.frame = base.at(starts[side], 0.25f * float(side));
    facade(mesh,
           {side & 1 ? d : w, spec.floor_height * float(floors), floors, (spec.street_sides >> side & 1) != 0,
            ground_floor},
           style, level);
  }
  mesh.frame = base;
  if (mesh.alpha() && detailsAt(level, true, style).bands) {
    slabs(mesh, w, d, spec.floor_height, floors, style);
  }
}

/// The rims below and above of walls that are a part of a solid.
struct WallRims {
  Rim bottom, top;
};

/// As walls(), with the vertices of edges shared.
WallRims closedWalls(MeshBuilder& mesh, const BuildingSpec& spec, float w, float d, uint32_t floors,
                     bool ground_floor, const Style& style, uint32_t level) {
  const Frame base = mesh.frame;
  const glm::vec3 starts[4] = {{0, 0, d}, {w, 0, d}, {w, 0, 0}, {0, 0, 0}};
  const float height = spec.floor_height * float(floors);
  const auto isStreet = [&](uint32_t side) { return (spec.street_sides >> side & 1) != 0; };
  std::array<Seam, 4> corners;
  for (uint32_t side = 0; side < 4; ++side) {
    const bool fine = detailsAt(level, isStreet(side), style).bands ||
                      detailsAt(level, isStreet((side + 3) & 3), style).bands;
    const uint32_t rows = fine ? floors : 1;
    for (uint32_t j = 0; j <= rows; ++j) {
      const float y = j == rows ? height : height / float(rows) * float(j);
      corners[side].push_back(mesh.vertex(starts[side] + glm::vec3(0, y, 0)));
    }
  }
  WallRims rims;
  for (uint32_t side = 0; side < 4; ++side) {
    mesh.frame = base.at(starts[side], 0.25f * float(side));
    const FacadeSeams seams = {corners[side], corners[(side + 1) & 3], rims.bottom.sides[side],
                               rims.top.sides[side]};
    facade(mesh, {side & 1 ? d : w, height, floors, isStreet(side), ground_floor}, style, level, &seams);
  }
  mesh.frame = base;
  return rims;
}

/// What closes the walls below a flat roof, but for the middle: the rim of that.
Rim closedParapet(MeshBuilder& mesh, Rim top, float w, float d, float y, uint32_t level) {
  if (level < 5) return top;
  constexpr float kWide = 0.3f, kHigh = 0.7f;
  const auto ring = [&](float inset, float height) {
    const uint32_t first = mesh.vertex({inset, height, d - inset});
    mesh.vertex({w - inset, height, d - inset});
    mesh.vertex({w - inset, height, inset});
    mesh.vertex({inset, height, inset});
    return rimOf({first, first + 1, first + 2, first + 3});
  };
  for (const Rim& next : {ring(0, y + kHigh), ring(kWide, y + kHigh), ring(kWide, y)}) {
    closeBetween(mesh, top, next);
    top = next;
  }
  return top;
}

void flatRoof(MeshBuilder& mesh, float w, float d, float y, uint32_t level) {
  if (level < 5) {
    mesh.quad({0, y, 0}, {0, y, d}, {w, y, d}, {w, y, 0});
    return;
  }
  const float t = 0.3f, top = y + 0.7f;
  const uint32_t first = uint32_t(mesh.vertexCount());
  const auto ring = [&](float inset, float height) {
    mesh.vertex({inset, height, inset});
    mesh.vertex({inset, height, d - inset});
    mesh.vertex({w - inset, height, d - inset});
    mesh.vertex({w - inset, height, inset});
  };
  ring(0, y);
  ring(0, top);
  ring(t, top);
  ring(t, y);
  for (uint32_t k = 0; k < 3; ++k) {
    for (uint32_t i = 0; i < 4; ++i) {
      const uint32_t a = first + 4 * k, j = (i + 1) & 3;
      mesh.quad(a + i, a + j, a + 4 + j, a + 4 + i);
    }
  }
  mesh.quad(first + 12, first + 13, first + 14, first + 15);
}

/// Two slopes in courses of tiles: how many of these, and tiles across.
struct Tiles {
  uint32_t courses, across;
  float rise, lift;

  Tiles(float d, uint32_t level)
      : courses(level < 5 ? 1 : std::min(60u, 4 * (level - 4))),
        across(level < 9 ? 1 : std::min(120u, 6 * (level - 8))),
        rise(d * 0.35f),
        // Each course starts with a riser: steps down a slope without a slit between them.
        lift(courses > 1 ? 0.03f : 0.0f) {}

  uint32_t rows() const { return 2 * courses - 1; }
  /// side: 1 or -1, of the slope; i along it, j = 0 .. rows() up.
  glm::vec3 point(float w, float d, float y, float side, uint32_t i, uint32_t j) const {
    const float s = float((j + 1) / 2) / float(courses), along = float(i) / float(across);
    const float step = j > 0 && j % 2 == 0 ? lift : 0;
    return {side > 0 ? w * along : w * (1 - along), y + rise * s + step, d / 2 + side * (d / 2) * (1 - s)};
  }
};

/// Slopes and gables that go on from the walls.
void closedGableRoof(MeshBuilder& mesh, const Rim& walls, float w, float d, float y, uint32_t level) {
  const Tiles tiles(d, level);
  std::array<std::vector<Seam>, 2> slopes;  // rows from the first above the eaves on
  for (size_t slope = 0; slope < 2; ++slope) {
    for (uint32_t j = 1; j <= tiles.rows(); ++j) {
      Seam row;
      for (uint32_t i = 0; i <= tiles.across; ++i) {
        const bool shared = slope == 1 && j == tiles.rows();  // the ridge
        row.push_back(shared ? slopes[0].back()[tiles.across - i]
                             : mesh.vertex(tiles.point(w, d, y, slope == 0 ? 1 : -1, i, j)));
      }
      closeBetween(mesh, row, j == 1 ? walls.sides[2 * slope] : slopes[slope].back());
      slopes[slope].push_back(std::move(row));
    }
  }
  for (size_t gable = 0; gable < 2; ++gable) {
    // Along the wall's upper edge, up the slope that begins at its end, down the other; its middle sees all.
    const std::vector<Seam>&up = slopes[1 - gable], &down = slopes[gable];
    Seam polygon = walls.sides[1 + 2 * gable];
    for (const Seam& row : up) polygon.push_back(row.front());
    for (size_t j = down.size() - 1; j-- > 0;) polygon.push_back(down[j].back());
    closeFan(mesh, mesh.vertex({gable == 0 ? w : 0, y + 0.25f * tiles.rise, d / 2}), polygon);
  }
}

/// Two slopes and the gables.
void gableRoof(MeshBuilder& mesh, float w, float d, float y, uint32_t level) {
  const Tiles tiles(d, level);
  const float rise = tiles.rise;
  const uint32_t gable = mesh.vertex({0, y, 0});
  mesh.vertex({0, y, d});
  mesh.vertex({0, y + rise, d / 2});
  mesh.triangle(gable, gable + 1, gable + 2);
  mesh.vertex({w, y, d});
  mesh.vertex({w, y, 0});
  mesh.vertex({w, y + rise, d / 2});
  mesh.triangle(gable + 3, gable + 4, gable + 5);
  for (const float side : {1.0f, -1.0f}) {
    mesh.sheet(tiles.across, tiles.rows(), false,
               [&](uint32_t i, uint32_t j) { return tiles.point(w, d, y, side, i, j); });
  }
}

/// Lift housing, boxes of air conditioning, a water tank, chimneys: on a flat roof.
void roofClutter(MeshBuilder& mesh, float w, float d, float y, uint32_t level, GeneratorRandom& random) {
  if (level < 5 || w < 8 || d < 8) return;
  const float lift_z = random.uniform(1, d - 5), lift_x = random.uniform(1, w / 2 - 3);
  const glm::vec3 lift(lift_x, y, lift_z);
  mesh.box(lift, lift + glm::vec3(3, 2.6f, 4), kNoLowY);
  if (level < 6) return;
  const uint32_t units = 1 + random.below(4);
  for (uint32_t i = 0; i < units; ++i) {
    const glm::vec3 p(w / 2 + 1 + float(i) * 1.4f, y + 0.2f, random.uniform(1, d / 2 - 1.5f));
    if (p.x > w - 2) break;
    mesh.box(p, p + glm::vec3(1, 0.9f, 0.8f));
  }
  if (level < 7 || !random.chance(0.5f)) return;
  const Frame base = mesh.frame;
  mesh.frame = base.at({w * 0.75f, y, d * 0.75f});
  const uint32_t sides = std::min(48u, 6 + level);
  const LathePoint tank[] = {{0, 1.4f}, {1.1f, 1.4f}, {1.1f, 3.2f}, {0, 3.9f}};
  mesh.lathe(tank, sides);
  for (const float x : {-0.7f, 0.62f}) {
    for (const float z : {-0.7f, 0.62f})
      mesh.box({x, 0, z}, {x + 0.08f, 1.4f, z + 0.08f}, kNoLowY | kNoHighY);
  }
  mesh.frame = base;
}

/// Walls, roof, and a smaller storey on it where the style has one, as one solid.
void closedBuilding(MeshBuilder& mesh, const BuildingSpec& spec, const Style& style, uint32_t level,
                    GeneratorRandom& random) {
  float w = spec.width, d = spec.depth;
  const uint32_t low_floors = style.setback ? spec.floors * 2 / 3 : spec.floors;
  WallRims rims = closedWalls(mesh, spec, w, d, low_floors, true, style, level);
  closeCap(mesh, rims.bottom, mesh.vertex({w / 2, 0, d / 2}), true);
  float y = spec.floor_height * float(low_floors);
  if (style.gable) return closedGableRoof(mesh, rims.top, w, d, y, level);
  Rim roof = closedParapet(mesh, rims.top, w, d, y, level);
  if (style.setback) {
    const float inset = std::min(w, d) * random.uniform(0.12f, 0.22f);
    w -= 2 * inset;
    d -= 2 * inset;
    mesh.frame = spec.frame.at({inset, y, inset});
    rims = closedWalls(mesh, spec, w, d, spec.floors - low_floors, false, style, level);
    closeBetween(mesh, roof, rims.bottom);
    y = spec.floor_height * float(spec.floors - low_floors);
    roof = closedParapet(mesh, rims.top, w, d, y, level);
  }
  closeCap(mesh, roof, mesh.vertex({w / 2, y, d / 2}));
  roofClutter(mesh, w, d, y, level, random);
}

}  // namespace

void makeBuilding(MeshBuilder& mesh, const BuildingSpec& spec, uint32_t level) {
  GeneratorRandom random(spec.seed, 0xb01d);
  const Style style = drawStyle(random, spec);
  mesh.frame = spec.frame;
  if (mesh.closed()) return closedBuilding(mesh, spec, style, level, random);
  float w = spec.width, d = spec.depth;
  const uint32_t low_floors = style.setback ? spec.floors * 2 / 3 : spec.floors;
  walls(mesh, spec, w, d, low_floors, true, style, level);
  float y = spec.floor_height * float(low_floors);
  if (style.gable) {
    gableRoof(mesh, w, d, y, level);
    return;
  }
  flatRoof(mesh, w, d, y, level);
  if (style.setback) {
    const float inset = std::min(w, d) * random.uniform(0.12f, 0.22f);
    w -= 2 * inset;
    d -= 2 * inset;
    mesh.frame = spec.frame.at({inset, y, inset});
    walls(mesh, spec, w, d, spec.floors - low_floors, false, style, level);
    y = spec.floor_height * float(spec.floors - low_floors);
    flatRoof(mesh, w, d, y, level);
  }
  roofClutter(mesh, w, d, y, level, random);
}

}  // namespace sightline
