// What glTF, OBJ and PLY files say of holes, glass and sides, and what is wrong with textures.
#include <gtest/gtest.h>
#include <png.h>
#include <webp/encode.h>

#include <cmath>

#include "core/formats/alpha_image.h"
#include "tests/scene/files.h"
#include "tests/scene/gltf_files.h"

namespace sightline::test {
namespace {

/// A PNG of RGBA texels with these alphas.
std::string pngOf(uint32_t width, uint32_t height, const std::vector<uint8_t>& alpha) {
  std::vector<uint8_t> rgba;
  for (const uint8_t a : alpha) rgba.insert(rgba.end(), {10, 20, 30, a});
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = width;
  image.height = height;
  image.format = PNG_FORMAT_RGBA;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  EXPECT_NE(png_image_write_to_memory(&image, bytes.data(), &size, 0, rgba.data(), 0, nullptr), 0);
  return bytes.substr(0, size);
}

/// The checksum of a PNG's chunk (ISO 3309).
uint32_t pngSum(const std::string& bytes) {
  uint32_t sum = ~0u;
  for (const char byte : bytes) {
    sum ^= uint8_t(byte);
    for (int bit = 0; bit < 8; ++bit) sum = (sum >> 1) ^ (0xedb88320u & (0u - (sum & 1u)));
  }
  return ~sum;
}

std::string webpOf(uint32_t width, uint32_t height, const std::vector<uint8_t>& alpha) {
  std::vector<uint8_t> rgba;
  for (const uint8_t a : alpha) rgba.insert(rgba.end(), {10, 20, 30, a});
  uint8_t* out = nullptr;
  const size_t size = WebPEncodeLosslessRGBA(rgba.data(), int(width), int(height), int(width * 4), &out);
  const std::string bytes(reinterpret_cast<char*>(out), size);
  WebPFree(out);
  return bytes;
}

/// The markers of a JPEG of 6 by 2 texels, and no more.
std::string jpegHeader() {
  return std::string("\xff\xd8\xff\xe0\x00\x04JF\xff\xc0\x00\x0b\x08\x00\x02\x00\x06\x01\x01\x11\x00", 21);
}

const std::vector<uint8_t> kAlpha = {255, 0, 128, 127, 60, 200};  // three by two

/// The square with a masked material and texture coordinates from corner to corner; the image at `uri`, or in
/// a view.
GltfFile maskedSquare(const std::string& image, const std::string& uri = "") {
  GltfFile file = squareFile<uint8_t>(5121);
  const std::vector<glm::vec2> uv = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  json& primitive = file.document["meshes"][0]["primitives"][0];
  primitive["attributes"]["TEXCOORD_0"] = file.addAccessor(file.addView(bytesOf(uv)), 5126, 4, "VEC2");
  primitive["material"] = 0;
  file.document["materials"] = {{{"alphaMode", "MASK"},
                                 {"doubleSided", true},
                                 {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  file.document["textures"] = {{{"source", 0}}};
  if (uri.empty()) {
    const size_t view = file.addView(image);
    file.document["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}}};
  } else {
    file.document["images"] = {{{"uri", uri}}};
  }
  return file;
}

Scene loadBytes(const std::string& name, const std::string& bytes, const SceneLoadOptions& options = {}) {
  const Folder folder;
  return loadScene(folder.write(name, bytes), options);
}

std::string errorOfFile(const GltfFile& file) {
  const Folder folder;
  const auto path = folder.write("a.glb", file.glb());
  std::string message = errorOf([&] { loadScene(path); });
  const size_t at = message.find("a.glb");
  EXPECT_NO_THROW(loadScene(path, {.opaque_masks = true})) << message;  // the remedy that each error names
  EXPECT_NE(message.find("--opaque-masks"), std::string::npos) << message;
  return at == std::string::npos ? message : message.substr(at);
}

/// Which texels of the scene's only mask hold.
std::string textOfMask(const Scene& scene) {
  EXPECT_EQ(scene.surfaces.masks.size(), 1u);
  const uvec4 mask = scene.surfaces.masks.at(0).size_wrap_first;
  std::string text = std::to_string(mask.x) + "x" + std::to_string(mask.y) + ":";
  for (uint32_t i = 0; i < mask.x * mask.y; ++i) {
    text += (scene.surfaces.texels[mask.w + i / 32] >> (i % 32) & 1u) != 0 ? '#' : '.';
  }
  return text;
}

/// Where the corners of a masked triangle lie, in texels.
std::vector<glm::dvec2> placesOf(const Scene& scene, size_t index) {
  const MaskedTriangle& t = scene.surfaces.masked.at(index);
  const auto place = [&](uint32_t x, uint32_t y) {
    return (glm::dvec2(x, y) - double(kTexelOffset)) * std::ldexp(1.0, -int(t.corner_c_mask.w));
  };
  return {place(t.corners_ab.x, t.corners_ab.y), place(t.corners_ab.z, t.corners_ab.w),
          place(t.corner_c_mask.x, t.corner_c_mask.y)};
}

TEST(GltfAlpha, ReadsMasksFromPngAndWebpWhereverTheyLie) {
  const std::string png = pngOf(3, 2, kAlpha);
  const std::string expected = "3x2:#.#..#";  // 128 / 255 is above the cutoff of 0.5, 127 / 255 below
  const Scene embedded = loadBytes("a.glb", maskedSquare(png).glb());
  EXPECT_EQ(textOfMask(embedded), expected);
  EXPECT_EQ(embedded.alpha_triangles, 2u);
  EXPECT_EQ(embedded.surfaces.words, (std::vector<uint32_t>{kSurfaceMasked, kSurfaceMasked | 1u}));
  const std::vector<glm::dvec2> lower = {{0, 2}, {3, 2}, {3, 0}}, upper = {{0, 2}, {3, 0}, {0, 0}};
  EXPECT_EQ(placesOf(embedded, 0), lower);
  EXPECT_EQ(placesOf(embedded, 1), upper);

  const std::string uri = "data:image/png;base64," + encodeBase64(png);
  EXPECT_EQ(hashScene(loadBytes("a.glb", maskedSquare(png, uri).glb())), hashScene(embedded));
  const Folder folder;
  folder.write("leaf.png", png);
  EXPECT_EQ(hashScene(loadScene(folder.write("a.glb", maskedSquare(png, "leaf.png").glb()))),
            hashScene(embedded));

  GltfFile webp = maskedSquare(webpOf(3, 2, kAlpha));
  webp.document["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}}};
  EXPECT_EQ(textOfMask(loadBytes("a.glb", webp.glb())), expected);
}

TEST(GltfAlpha, WeighsFactorAndCutoff) {
  GltfFile file = maskedSquare(pngOf(3, 2, kAlpha));
  json& material = file.document["materials"][0];
  material["alphaCutoff"] = 0.2;  // 51 / 255
  EXPECT_EQ(textOfMask(loadBytes("a.glb", file.glb())), "3x2:#.####");
  material["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.25};
  EXPECT_EQ(textOfMask(loadBytes("a.glb", file.glb())), "3x2:#.....");
  material["alphaCutoff"] = 0;
  EXPECT_TRUE(loadBytes("a.glb", file.glb()).surfaces.empty());  // all holds
  material["pbrMetallicRoughness"].erase("baseColorTexture");
  material["alphaCutoff"] = 0.3;
  EXPECT_EQ(textOfMask(loadBytes("a.glb", file.glb())), "1x1:.");  // the factor alone: nothing is there
  material["alphaCutoff"] = 0.25;
  EXPECT_TRUE(loadBytes("a.glb", file.glb()).surfaces.empty());
}

TEST(GltfAlpha, TakesJpegsAsOpaque) {
  GltfFile file = maskedSquare(jpegHeader());
  EXPECT_TRUE(loadBytes("a.glb", file.glb()).surfaces.empty());
  file.document["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.4};
  EXPECT_EQ(textOfMask(loadBytes("a.glb", file.glb())), "1x1:.");
}

TEST(GltfAlpha, PlacesCornersBySamplerSetAndTransform) {
  GltfFile file = maskedSquare(pngOf(3, 2, kAlpha));
  json& primitive = file.document["meshes"][0]["primitives"][0];
  const std::vector<uint16_t> half = {0, 65535, 32768, 65535, 32768, 0, 0, 0};  // normalised, in set 1
  primitive["attributes"]["TEXCOORD_1"] = file.addAccessor(file.addView(bytesOf(half)), 5123, 4, "VEC2");
  file.document["accessors"].back()["normalized"] = true;
  json& texture = file.document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
  texture["texCoord"] = 1;
  const std::vector<glm::dvec2> halved = placesOf(loadBytes("a.glb", file.glb()), 0);
  EXPECT_NEAR(halved[1].x, 1.5, 1e-4);
  EXPECT_EQ(halved[1].y, 2.0);

  // A quarter turn counter-clockwise, twice as wide, one image to the right; clamped, so that none is taken
  // off.
  texture["extensions"]["KHR_texture_transform"] = {
      {"texCoord", 0}, {"offset", {1, 0.5}}, {"rotation", 1.5707963267948966}, {"scale", {2, 1}}};
  file.document["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33071}}};
  file.document["textures"][0]["sampler"] = 0;
  const std::vector<glm::dvec2> turned = placesOf(loadBytes("a.glb", file.glb()), 0);
  const glm::dvec2 expected[] = {{6, 1}, {6, -3}, {3, -3}};  // (1 + v, 0.5 - 2 u) images
  for (int i = 0; i < 3; ++i) EXPECT_LT(glm::length(turned[size_t(i)] - expected[i]), 1e-4) << i;

  file.document["samplers"][0] = {{"wrapS", 10497}, {"wrapT", 33648}};  // whole repetitions are taken off
  const std::vector<glm::dvec2> wrapped = placesOf(loadBytes("a.glb", file.glb()), 0);
  const glm::dvec2 inside[] = {{3, 5}, {3, 1}, {0, 1}};
  for (int i = 0; i < 3; ++i) EXPECT_LT(glm::length(wrapped[size_t(i)] - inside[i]), 1e-4) << i;
}

TEST(GltfAlpha, BlendAndTransmissionAreSeenThrough) {
  GltfFile file = squareFile<uint8_t>(5121);
  file.document["meshes"][0]["primitives"][0]["material"] = 0;
  const std::vector<uint32_t> glass(2, kSurfaceGlass);
  file.document["materials"] = {{{"alphaMode", "BLEND"}}};
  EXPECT_EQ(loadBytes("a.glb", file.glb()).surfaces.words, glass);
  file.document["materials"] = {
      {{"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 0.1}}}}}}};
  EXPECT_EQ(loadBytes("a.glb", file.glb()).surfaces.words, glass);
  EXPECT_EQ(loadBytes("a.glb", file.glb(), {.cull_back_faces = true}).surfaces.words,
            (std::vector<uint32_t>(2, kSurfaceGlass | kSurfaceFrontOnly)));
  file.document["materials"][0]["doubleSided"] = true;
  EXPECT_EQ(loadBytes("a.glb", file.glb(), {.cull_back_faces = true}).surfaces.words, glass);
}

TEST(ObjSurfaces, AreSeenThroughByTheirMaterialAndSingleSidedOnDemand) {
  const Folder folder;
  folder.write("m.mtl", "newmtl pane\nd 0.4\nnewmtl wall\nd 1\n");
  const auto file = folder.write("a.obj",
                                 "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\n"
                                 "usemtl pane\nf 1 2 3 4\nusemtl wall\nf 1 2 3\nusemtl pane\nf 2 3 4\n");
  EXPECT_EQ(loadScene(file).surfaces.words,
            (std::vector<uint32_t>{0, kSurfaceGlass, kSurfaceGlass, 0, kSurfaceGlass}));
  const uint32_t front = kSurfaceFrontOnly, both = kSurfaceFrontOnly | kSurfaceGlass;
  EXPECT_EQ(loadScene(file, {.cull_back_faces = true}).surfaces.words,
            (std::vector<uint32_t>{front, both, both, front, both}));
  const auto plain = folder.write("b.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
  EXPECT_TRUE(loadScene(plain).surfaces.empty());
  EXPECT_NE(hashScene(loadScene(plain)), hashScene(loadScene(plain, {.cull_back_faces = true})));
}

TEST(GltfAlpha, SaysWhatIsWrongWithAMask) {
  const std::string png = pngOf(3, 2, kAlpha);
  const auto expect = [](const GltfFile& file, const std::string& part) {
    const std::string message = errorOfFile(file);
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  GltfFile file = maskedSquare(png);
  for (const double cutoff : {-0.1, 1.5}) {
    file.document["materials"][0]["alphaCutoff"] = cutoff;
    expect(file, "materials[0].alphaCutoff: ");
  }
  file = maskedSquare(png);
  file.document["meshes"][0]["primitives"][0]["attributes"].erase("TEXCOORD_0");
  expect(file, "meshes[0].primitives[0].attributes.TEXCOORD_0: is missing");
  expect(maskedSquare(png, "none.png"), "images[0].uri");
  expect(maskedSquare(png, "../a.png"), "images[0].uri");
  expect(maskedSquare("GIF89a and more"), "images[0]: GIF images are not read");
  expect(maskedSquare(std::string("\xabKTX 20\xbb\r\n\x1a\n and more", 21)),
         "images[0]: KTX2 images are not read");
  expect(maskedSquare("nothing of the kind"), "images[0]: no image that is read");
  expect(maskedSquare(png.substr(0, png.size() / 2)), "images[0]: a PNG image that");
  expect(maskedSquare(webpOf(3, 2, kAlpha).substr(0, 30)),
         "images[0]: a WebP image that is damaged or cut off");
  expect(maskedSquare(jpegHeader().substr(0, 12)), "images[0]: a JPEG image that is damaged or cut off");
  file = maskedSquare(png);
  file.document["textures"] = json::array({json::object()});
  expect(file, "textures[0]: has no image that is read");
  file = maskedSquare(png);
  const std::vector<glm::vec2> far = {{0, 1}, {1, NAN}, {1, 0}, {0, 0}};
  file.document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] =
      file.addAccessor(file.addView(bytesOf(far)), 5126, 4, "VEC2");
  expect(file, "texture coordinates of the triangle");
}

/// A file of a few bytes must not cost gigabytes: neither by what an image claims to be ...
TEST(GltfAlpha, RefusesSizesThatTheBytesCannotStandFor) {
  const std::string png = pngOf(3, 2, kAlpha);
  const std::string claim("\x00\x00\x40\x00\x00\x00\x40\x00", 8);  // 2^14 by 2^14
  std::string large = png;
  large.replace(16, 8, claim);
  const uint32_t sum = pngSum(large.substr(12, 17));  // of IHDR
  for (int i = 0; i < 4; ++i) large[29 + size_t(i)] = char(sum >> (24 - 8 * i));
  EXPECT_NE(errorOfFile(maskedSquare(large)).find("images[0]: claims 16384 x 16384 texels in "),
            std::string::npos);
  std::string webp = webpOf(3, 2, kAlpha);
  const size_t head = webp.find("VP8L") + 9;
  ASSERT_EQ(webp[head - 1], 0x2f);
  webp.replace(head, 4, std::string("\xfe\xff\xff\x1f", 4));  // 16383 by 16384, with alpha
  EXPECT_NE(errorOfFile(maskedSquare(webp)).find("claims 16383 x 16384 texels in "), std::string::npos);
  // A large picture of one colour is as small as any.
  const std::vector<uint8_t> flat(4200 * 4200, 100);
  EXPECT_EQ(loadBytes("a.glb", maskedSquare(pngOf(4200, 4200, flat)).glb()).surfaces.masks.size(), 1u);
}

/// ... nor by how often it is named.
TEST(GltfAlpha, RefusesToReadAPictureTooOften) {
  const std::vector<uint8_t> flat(4096 * 4096, 100);
  GltfFile file = maskedSquare(webpOf(4096, 4096, flat));
  const json material = file.document["materials"][0],
             primitive = file.document["meshes"][0]["primitives"][0];
  for (int i = 1; i < 18; ++i) {
    file.document["materials"].push_back(material);
    file.document["materials"][size_t(i)]["alphaCutoff"] = 0.5 + 0.01 * i;
    file.document["meshes"][0]["primitives"].push_back(primitive);
    file.document["meshes"][0]["primitives"][size_t(i)]["material"] = i;
  }
  EXPECT_NE(errorOfFile(file).find("the texels of its masks are far too many for"), std::string::npos);
}

TEST(GltfAlpha, EveryShorterOrChangedImageIsReadOrRefused) {
  for (const std::string& whole : {pngOf(3, 2, kAlpha), webpOf(3, 2, kAlpha), jpegHeader()}) {
    const auto read = [](const std::string& bytes) {
      // Copied, so that a sanitizer sees whoever reads beyond the end.
      const std::vector<uint8_t> copy(bytes.begin(), bytes.end());
      try {
        return readAlphaImage(copy, "image").width;
      } catch (const Error&) {
        return 0u;
      }
    };
    EXPECT_GT(read(whole), 0u);
    for (size_t length = 0; length < whole.size(); ++length) read(whole.substr(0, length));
    for (size_t i = 0; i < whole.size(); ++i) {
      for (const int change : {1, 0x80, 0xff}) {
        std::string changed = whole;
        changed[i] = char(changed[i] ^ change);
        read(changed);
      }
    }
  }
}

}  // namespace
}  // namespace sightline::test
