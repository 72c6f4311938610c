#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/crosscheck/ray_answers.h"

namespace sightline {

/// A ray with the few triangles around it, on which devices answer it as on the whole scene.
struct Reproducer {
  Scene scene;                      ///< the triangles, in the order of their ids in the whole scene; of their
                                    ///< surfaces only what is glass, no holes and no sides
  std::vector<uint32_t> triangles;  ///< these ids
  RayAnswers answers;               ///< on this scene alone, in its own ids
  RayAnswers whole;                 ///< on the whole scene, in its ids
  bool reproduces = false;  ///< each device gives the same triangle and t as on the whole scene, and the
                            ///< judge the same verdict
};

/// Makes device number d for another scene and its tree, which outlive it.
using DeviceMaker = std::function<std::unique_ptr<Tracer>(size_t d, const Scene& scene, const Bvh& bvh)>;

/// Looks for triangles around the ray that are enough: those that a device or the judge names and what the
/// ray passes within rounding; then what shares leaves with them; then what lies about the whole ray. Where
/// none is enough, the last. whole: the answers on the judge's scene, which `scene` is. Throws Error.
Reproducer findReproducer(const Scene& scene, const Judge& judge, const RayAnswers& whole,
                          const DeviceMaker& makeDevice, const RoundingLimit& limit = {});

/// What a reproducer's file says beside the triangles.
struct ReproducerHead {
  std::string what;                  ///< "vertex ray 17 of cell street-1"
  std::string scene_name;            ///< of the whole scene
  std::vector<std::string> devices;  ///< ids
  std::string file_name;             ///< of the file
  std::string options;               ///< of the command that repeats it, e.g. " --rounding 4"; else empty
};

/// An OBJ whose comments say all: the ray, the answers, the verdicts, and the command that repeats it. Its
/// vertices are decimals that read back to the same floats.
std::string reproducerText(const ReproducerHead& head, const Reproducer& reproducer);

/// What reproducers with glass name as their materials, to be written beside them.
inline constexpr const char* kMaterialsName = "disagreement-glass.mtl";
std::string materialsText();

/// "disagreement-0001.obj" for 0, ...
std::string reproducerName(size_t number);

/// Makes the folder. Throws Error if there are files in it, unless they may be overwritten, and then if it
/// holds one of `inputs`.
void prepareReproducerFolder(const std::filesystem::path& folder, bool overwrite,
                             std::span<const std::filesystem::path> inputs);
/// Removes the reproducers in the folder, and nothing else; returns how many there were. Throws Error.
size_t removeReproducers(const std::filesystem::path& folder);

}  // namespace sightline
