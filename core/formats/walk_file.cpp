#include "core/formats/walk_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/error.h"
#include "core/formats/json_object.h"
#include "core/formats/json_text.h"
#include "core/io/file_io.h"

namespace sightline {
namespace {

using nlohmann::json;

/// Keys that begin so belong to whoever wrote them, and are not looked at.
constexpr std::string_view kForeignKeys = "x-";

void checkWalkKeys(const JsonObject& object, std::initializer_list<std::string_view> allowed) {
  for (const std::string& key : object.keys()) {
    if (key.starts_with(kForeignKeys) || std::ranges::find(allowed, key) != allowed.end()) continue;
    object.fail(fmt::format("unknown key {}, expected one of {}, or {}... for keys of other programs",
                            json(key).dump(-1, ' ', false, json::error_handler_t::replace),
                            fmt::join(allowed, ", "), kForeignKeys));
  }
}

glm::dvec3 requiredPoint(const JsonObject& object, const char* key) {
  const auto numbers = object.numbers(key, 3);
  if (!numbers) object.fail(fmt::format("key \"{}\" is missing", key));
  return {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
}

/// Frames past kMostPathFrames end up just past it, where pathProblem finds them.
uint32_t frameNumber(uint64_t number) {
  return uint32_t(std::min<uint64_t>(number, kMostPathFrames));
}

CameraPath readWalk(const JsonObject& document) {
  checkWalkKeys(document, {"fov", "keys", "cuts"});
  if (!document.has("keys")) document.fail("key \"keys\" is missing");
  CameraPath path;
  path.fov = document.real("fov").value_or(kDefaultPathFov);
  for (const JsonObject& key : document.objects("keys")) {
    checkWalkKeys(key, {"frame", "eye", "look"});
    path.keys.push_back(
        {frameNumber(key.requiredNumber("frame")), {requiredPoint(key, "eye"), requiredPoint(key, "look")}});
  }
  for (const size_t cut : document.indices("cuts", kMostPathFrames)) path.cuts.push_back(uint32_t(cut));
  return path;
}

std::string pointText(const glm::dvec3& value) {
  return fmt::format("[{}, {}, {}]", json(value.x).dump(), json(value.y).dump(), json(value.z).dump());
}

void checkPath(const CameraPath& path, const std::string& file) {
  if (const auto problem = pathProblem(path)) {
    throw Error(fmt::format("{}: {}: {}", file, problem->place, problem->what), kExitUsage);
  }
}

}  // namespace

CameraPath loadWalk(const std::filesystem::path& file) {
  return parseWalk(readFile(file).view(), file.string());
}

CameraPath parseWalk(std::string_view text, const std::string& file) {
  try {
    if (text.empty()) throw Error(fmt::format("{}: is empty, expected {{\"keys\":[...]}}", file));
    const json document = parseJson(text, file);
    CameraPath path = readWalk(JsonObject(document, file, ""));
    checkPath(path, file);
    return path;
  } catch (const Error& error) {
    throw Error(error.what(), kExitUsage);
  }
}

std::string walkText(const CameraPath& path, const std::string& file) {
  checkPath(path, file);
  std::string text = fmt::format("{{\"fov\": {}, \"keys\": [\n", json(path.fov).dump());
  for (size_t i = 0; i < path.keys.size(); ++i) {
    const PathKey& key = path.keys[i];
    text += fmt::format("  {{\"frame\": {}, \"eye\": {}, \"look\": {}}}{}\n", key.frame,
                        pointText(key.at.eye), pointText(key.at.look), i + 1 < path.keys.size() ? "," : "");
  }
  return text + fmt::format("], \"cuts\": [{}]}}\n", fmt::join(path.cuts, ", "));
}

}  // namespace sightline
