#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/cell/view_cell.h"
#include "core/path/camera_path.h"
#include "core/scene/scene.h"
#include "core/scene/scene_stream.h"

namespace sightline {

/// Range of triangle counts that generateScene takes.
inline constexpr uint64_t kMinGeneratedTriangles = 1'000;
inline constexpr uint64_t kMaxGeneratedTriangles = 20'000'000;
/// Most triangles of "scan".
inline constexpr uint64_t kMaxScanTriangles = 200'000'000;
/// The same with instances.
inline constexpr uint64_t kMaxRepeatedTriangles = 1'000'000'000;
/// Most kinds of modules.
inline constexpr uint32_t kMaxKinds = 1000;
/// Fewest frames of a walk: below, its turn is none.
inline constexpr uint32_t kMinWalkFrames = 60;

/// The scenes that can be generated, with a line on each for --help.
struct GeneratedSceneInfo {
  std::string name;
  std::string about;
};
const std::vector<GeneratedSceneInfo>& generatedScenes();

/// What a scene may have beyond its plain form.
struct SceneExtras {
  /// "city" and "bistro" have leaves with holes (Surfaces), and windows and bottles of glass, each as objects
  /// of their own; through windows one sees the floors of a house. Cells are the same.
  bool alpha = false;
  /// "city": houses, pavements and the road are solid: each edge of their objects is that of two triangles,
  /// once in each direction, and these face outwards. What stands in the streets is not. Not with alpha.
  bool closed = false;
  /// "scan": the surface is open in some two dozen places, as scans are: fewer triangles by a few percent.
  bool holes = false;
};

/// Generates "city", "canyon", "plant", "bistro" or "scan". Metres, y up, ground near y = 0. The result has
/// at most `triangles` triangles, and at least 0.97 of them (0.85 below 10,000). Extent and detail both grow
/// with the count (of "scan": detail). Same name, count and seed: same bytes (only +, -, *, / and square
/// roots enter the coordinates, no function of libm whose last digit differs by platform). No triangle is
/// degenerate; each building, prop or pipe is an object of its own, with its vertices shared. Throws Error
/// with exit code 2 for an unknown name or a count out of kMinGeneratedTriangles..kMaxGeneratedTriangles
/// ("scan": kMaxScanTriangles), and for extras that the scene does not have.
Scene generateScene(const std::string& name, uint64_t triangles, uint64_t seed,
                    const SceneExtras& extras = {});

/// The scan that generateScene makes of the same arguments, in pieces: 200 million triangles take no more
/// memory than a million. Before, the vertices are made once for their bounds: `measured` is told how many of
/// them are done, on the caller's thread. Throws as generateScene.
SceneStream streamScan(uint64_t triangles, uint64_t seed, const SceneExtras& extras = {},
                       const std::function<void(uint32_t vertices, uint32_t of)>& measured = {});

/// Generates "city" or "plant" of at most so many kinds of modules (blocks of houses; bays of a plant, half
/// of them mirrored, and aisles), 1 .. kMaxKinds, each an instance: the count is of all, whatever is stored
/// once. closed: as of SceneExtras. Else as generateScene.
Scene generateRepeated(const std::string& name, uint64_t triangles, uint64_t seed, uint32_t kinds,
                       bool closed = false);

/// Whether generateRepeated knows the scene.
bool canRepeat(const std::string& name);

/// Ten view cells in free space of the scene that generateRepeated makes of the same arguments.
std::vector<ViewCell> generateRepeatedCells(const std::string& name, uint64_t triangles, uint64_t seed,
                                            uint32_t kinds);

/// Ten view cells in free space of the scene that generateScene makes of the same arguments: of each kind of
/// the thesis some, named by it: flat-1 (a rectangle that looks along its normal), box-1 (a volume), street-1
/// (long and narrow along a street, canyon or aisle). Throws as generateScene.
std::vector<ViewCell> generateCells(const std::string& name, uint64_t triangles, uint64_t seed);

/// A walk through free space of the scene that generateScene makes of the same arguments, or generateRepeated
/// with kinds: on street level (aisle, river); a fast turn in the first third of it; a cut to another street,
/// the other way or another storey; a cut, and a rise until the whole scene is seen. In the bistro it goes
/// close along the facades, which hide all. The same parts at the same share of the frames in all scenes.
/// frames: kMinWalkFrames .. kMostPathFrames. Throws as generateScene.
CameraPath generateWalk(const std::string& name, uint64_t triangles, uint64_t seed, uint32_t frames,
                        uint32_t kinds = 0);

}  // namespace sightline
