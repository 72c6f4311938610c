#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/generate/mesh_builder.h"
#include "core/scene/scene.h"

namespace sightline {

/// A thing in a generated scene that can be made with more or fewer triangles.
struct ScenePart {
  std::string name;
  /// Level 0 is the coarsest (may be nothing at all); levels past it are as high as the count demands. Must
  /// depend on its arguments only, and ask the builder for nothing but to add shapes.
  std::function<void(MeshBuilder&, uint32_t level)> make;
  /// The highest level that is of use.
  uint32_t max_level = 0;
  uint64_t copies = 1;  ///< how often the scene shows it: of assembleModules
};

/// Parts that are made once, together, and shown in several places.
struct SceneModule {
  struct Place {
    std::string name;
    Placement place;
  };
  std::vector<ScenePart> parts;
  std::vector<Place> places;
};

/// What makes a scene: parts, and modules as instances behind them.
struct RepeatedScene {
  std::vector<ScenePart> parts;
  std::vector<SceneModule> modules;
};

/// Makes all parts, in order, at levels such that the scene has as close to `triangles` triangles as the
/// levels allow, never more: first all at the highest common level, then single ones, in an order drawn from
/// seed, one level higher for as long as they fit. Parts without triangles are left out.
/// Throws Error when even level 0 is more than `triangles`.
/// options.alpha: with panes of glass and leaves with holes, where parts have them. Of such a part the
/// triangles come in the order of Matter, each as an object: "NAME", "NAME-panes", "NAME-leaves"; the
/// vertices of all leaves are the scene's last.
Scene assembleScene(const std::vector<ScenePart>& parts, uint64_t triangles, uint64_t seed,
                    const MeshOptions& options = {});

/// The same of a scene with modules: each of their places counts, is an object, and an instance of the scene,
/// behind the parts.
Scene assembleModules(RepeatedScene repeated, uint64_t triangles, uint64_t seed,
                      const MeshOptions& options = {});

}  // namespace sightline
