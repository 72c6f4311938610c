#include "core/formats/gltf_alpha.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/cell/rotation.h"

namespace sightline {
namespace {

constexpr double kDegreesARadian = 57.295779513082320877;
constexpr const char* kRemedy = "mend the file, or take its masks as opaque: --opaque-masks";
/// A small file may name a picture any number of times, with cutoffs of its own. What that may cost is a
/// number of texels for each byte of it and its pictures; some are free, for pictures of one colour.
constexpr uint64_t kTexelsAByteOfAll = 4096;
constexpr uint64_t kFreeTexelsOfAll = uint64_t(1) << 28;

}  // namespace

GltfAlpha::GltfAlpha(const GltfDocument& document, GltfData& data, const std::string& file,
                     uint64_t file_bytes, const SceneLoadOptions& options, Surfaces& surfaces)
    : document_(document),
      data_(data),
      file_(file),
      file_bytes_(file_bytes),
      options_(options),
      surfaces_(surfaces) {}

const GltfSurface& GltfAlpha::surface(size_t mesh, size_t primitive) {
  const auto [entry, is_new] = of_primitives_.try_emplace({mesh, primitive});
  GltfSurface& surface = entry->second;
  if (!is_new) return surface;
  const GltfPrimitive& shape = document_.meshes[mesh].primitives[primitive];
  const GltfMaterial& material = shape.material;
  if (material.glass || material.alpha == GltfMaterial::Alpha::kBlend) surface.flags |= kSurfaceGlass;
  if (options_.cull_back_faces && !material.double_sided) surface.flags |= kSurfaceFrontOnly;
  if (material.alpha != GltfMaterial::Alpha::kMask || options_.opaque_masks) return surface;
  surface.mask = mask(material);
  if (!surface.mask) return surface;
  readPlaces(shape, fmt::format("{}: meshes[{}].primitives[{}]", file_, mesh, primitive), surface);
  return surface;
}

std::optional<uint32_t> GltfAlpha::mask(const GltfMaterial& material) {
  if (!(material.cutoff >= 0.0 && material.cutoff <= 1.0)) {
    throw Error(fmt::format("{}: {}.alphaCutoff: {} is out of range, expected 0 to 1; {}", file_,
                            material.place, material.cutoff, kRemedy));
  }
  const auto holds = [&](uint16_t alpha) { return alpha / 65535.0 * material.factor >= material.cutoff; };
  if (!material.texture) return holds(65535) ? std::nullopt : hole();
  const GltfAlphaTexture& texture = *material.texture;
  if (!texture.image) {
    throw Error(fmt::format("{}: {}: has no image that is read: PNG, JPEG or WebP; {}", file_, texture.place,
                            kRemedy));
  }
  const glm::uvec2 wraps = texture.wraps;
  const auto [entry, is_new] =
      masks_.try_emplace({*texture.image, material.factor, material.cutoff, wraps.x + 4 * wraps.y});
  if (!is_new) return entry->second;
  const AlphaImage& image = this->image(*texture.image);
  if (image.alpha.empty()) {
    if (!holds(65535)) entry->second = hole();
    return entry->second;
  }
  spend(image.alpha.size());
  if (!std::ranges::all_of(image.alpha, holds)) {
    entry->second = addMask(surfaces_, image.width, image.height, wraps,
                            [&](uint64_t texel) { return holds(image.alpha[texel]); });
  }
  return entry->second;
}

std::optional<uint32_t> GltfAlpha::hole() {
  if (!nothing_) {
    nothing_ = addMask(surfaces_, 1, 1, {kWrapClamp, kWrapClamp}, [](uint64_t) { return false; });
  }
  return nothing_;
}

void GltfAlpha::spend(uint64_t texels) {
  texels_ += texels;
  if (texels_ <= kFreeTexelsOfAll + kTexelsAByteOfAll * file_bytes_) return;
  throw Error(fmt::format("{}: the texels of its masks are far too many for {} bytes of pictures; {}", file_,
                          file_bytes_, kRemedy));
}

const AlphaImage& GltfAlpha::image(size_t index) {
  if (last_image_ == index) return image_;
  last_image_.reset();
  image_ = {};  // before the next one takes room
  const GltfImage& source = document_.images[index];
  const std::string place = fmt::format("{}: images[{}]", file_, index);
  if (source.uri) {
    std::vector<uint8_t> bytes;
    try {
      bytes = data_.resource(*source.uri, place + ".uri");
    } catch (const Error& error) {
      throw Error(fmt::format("{}; {}", error.what(), kRemedy));
    }
    if (uris_.insert(*source.uri).second) file_bytes_ += bytes.size();
    image_ = readAlphaImage(bytes, place);
  } else if (source.view) {
    image_ = readAlphaImage(data_.view(*source.view), place);
  } else {
    throw Error(fmt::format("{}: has neither uri nor bufferView; {}", place, kRemedy));
  }
  last_image_ = index;
  return image_;
}

void GltfAlpha::readPlaces(const GltfPrimitive& primitive, const std::string& place, GltfSurface& surface) {
  const uint64_t count = document_.accessors[*primitive.positions].count;
  if (surface.mask == nothing_) {
    surface.places.assign(count, glm::dvec2(0.0));
    return;
  }
  const GltfAlphaTexture& texture = *primitive.material.texture;
  if (!primitive.mask_uv) {
    throw Error(fmt::format("{}.attributes.TEXCOORD_{}: is missing, but the alpha of {} needs it; {}", place,
                            texture.uv_set, texture.place, kRemedy));
  }
  surface.place = fmt::format("{}: accessors[{}]", file_, *primitive.mask_uv);
  const GltfAccessor& accessor = document_.accessors[*primitive.mask_uv];
  if (accessor.width != 2 || accessor.count != count) {
    throw Error(fmt::format("{}: texture coordinates need VEC2 and a count of {}, one a position; {}",
                            surface.place, count, kRemedy));
  }
  GltfReader reader(document_, data_, *primitive.mask_uv, file_);
  const CosSin turn = cosSinDegrees(texture.rotation * kDegreesARadian);
  const uvec4 size = surfaces_.masks[*surface.mask].size_wrap_first;
  for (uint64_t i = 0; i < count; ++i) {
    const double u = reader.component(i, 0) * texture.scale.x, v = reader.component(i, 1) * texture.scale.y;
    const glm::dvec2 turned(turn.cosine * u + turn.sine * v, turn.cosine * v - turn.sine * u);
    surface.places.push_back((texture.offset + turned) * glm::dvec2(size.x, size.y));
  }
}

uint32_t GltfAlpha::addTriangle(const GltfSurface& surface, int64_t a, int64_t b, int64_t c) {
  if (!surface.mask) return surface.flags;
  const auto at = [&](int64_t vertex) { return surface.places[size_t(vertex)]; };
  const auto record = maskedTriangle(surfaces_, *surface.mask, {at(a), at(b), at(c)});
  if (!record) {
    throw Error(
        fmt::format("{}: texture coordinates of the triangle of elements {}, {} and {} are not finite or "
                    "too large; {}",
                    surface.place, a, b, c, kRemedy));
  }
  if (surfaces_.masked.size() > kSurfaceIndex) {
    throw Error(fmt::format("{}: more than {} triangles with masks; {}", file_, kSurfaceIndex, kRemedy));
  }
  surfaces_.masked.push_back(*record);
  return surface.flags | kSurfaceMasked | uint32_t(surfaces_.masked.size() - 1);
}

}  // namespace sightline
