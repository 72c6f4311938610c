// Based on: Khronos Group, glTF 2.0 Specification, 2021, sections 3.8 (textures) and 3.9 (materials);
// KHR_texture_transform, KHR_materials_transmission, EXT_texture_webp, KHR_texture_basisu.
#include "core/formats/gltf_materials.h"

#include <fmt/format.h>

#include "core/shared/surface.h"

namespace sightline {
namespace {

std::optional<JsonObject> extension(const JsonObject& object, const char* name) {
  const auto extensions = object.object("extensions");
  return extensions ? extensions->object(name) : std::nullopt;
}

uint32_t readWrap(const JsonObject& sampler, const char* key) {
  const uint64_t wrap = sampler.number(key).value_or(10497);
  if (wrap == 10497) return kWrapRepeat;
  if (wrap == 33648) return kWrapMirror;
  if (wrap == 33071) return kWrapClamp;
  sampler.fail(key, fmt::format("{} is none of 10497 (repeat), 33648 (mirrored) and 33071 (clamp)", wrap));
}

/// The image: PNG or JPEG as the format has them, else one that an extension names.
std::optional<size_t> readSource(const JsonObject& texture, size_t images) {
  if (const auto source = texture.index("source", images)) return source;
  for (const char* name :
       {"EXT_texture_webp", "KHR_texture_basisu", "MSFT_texture_dds", "EXT_texture_avif"}) {
    if (const auto other = extension(texture, name)) return other->index("source", images);
  }
  return std::nullopt;
}

GltfAlphaTexture readTexture(const JsonObject& info, const JsonObject& document) {
  const std::vector<JsonObject> textures = document.objects("textures");
  const std::vector<JsonObject> samplers = document.objects("samplers");
  const size_t index = info.requiredIndex("index", textures.size());
  const JsonObject& texture = textures[index];
  GltfAlphaTexture result;
  result.place = fmt::format("textures[{}]", index);
  result.image = readSource(texture, document.objects("images").size());
  if (const auto sampler = texture.index("sampler", samplers.size())) {
    result.wraps = {readWrap(samplers[*sampler], "wrapS"), readWrap(samplers[*sampler], "wrapT")};
  }
  result.uv_set = info.number("texCoord").value_or(0);
  const auto transform = extension(info, "KHR_texture_transform");
  if (!transform) return result;
  const auto pair = [&](const char* key, double missing) {
    const auto numbers = transform->numbers(key, 2);
    return numbers ? glm::dvec2((*numbers)[0], (*numbers)[1]) : glm::dvec2(missing);
  };
  result.offset = pair("offset", 0.0);
  result.scale = pair("scale", 1.0);
  result.rotation = transform->real("rotation").value_or(0.0);
  if (const auto set = transform->number("texCoord")) result.uv_set = *set;
  return result;
}

/// Where a material's base colour stands: KHR_materials_pbrSpecularGlossiness names it otherwise.
void readBaseColour(const JsonObject& material, const JsonObject& document, GltfMaterial& result) {
  const auto metallic = material.object("pbrMetallicRoughness");
  const auto glossy = extension(material, "KHR_materials_pbrSpecularGlossiness");
  const bool is_glossy = !metallic && glossy;
  const std::optional<JsonObject>& colour = is_glossy ? glossy : metallic;
  if (!colour) return;
  if (const auto factor = colour->numbers(is_glossy ? "diffuseFactor" : "baseColorFactor", 4)) {
    result.factor = (*factor)[3];
  }
  const auto texture = colour->object(is_glossy ? "diffuseTexture" : "baseColorTexture");
  if (texture) result.texture = readTexture(*texture, document);
}

}  // namespace

std::vector<GltfMaterial> readMaterials(const JsonObject& document) {
  std::vector<GltfMaterial> materials;
  for (const JsonObject& object : document.objects("materials")) {
    GltfMaterial& material = materials.emplace_back();
    material.place = fmt::format("materials[{}]", materials.size() - 1);
    material.double_sided = object.boolean("doubleSided", false);
    const auto transmission = extension(object, "KHR_materials_transmission");
    // A texture only takes some of the factor away, which is 0 unless the file says otherwise.
    material.glass = transmission && transmission->real("transmissionFactor").value_or(0.0) > 0.0;
    const std::string mode = object.text("alphaMode").value_or("OPAQUE");
    if (mode == "BLEND") material.alpha = GltfMaterial::Alpha::kBlend;
    if (mode != "MASK") continue;
    material.alpha = GltfMaterial::Alpha::kMask;
    material.cutoff = object.real("alphaCutoff").value_or(0.5);
    readBaseColour(object, document, material);
  }
  return materials;
}

std::vector<GltfImage> readImages(const JsonObject& document, size_t views) {
  std::vector<GltfImage> images;
  for (const JsonObject& object : document.objects("images")) {
    images.push_back({object.text("uri"), object.index("bufferView", views)});
  }
  return images;
}

}  // namespace sightline
