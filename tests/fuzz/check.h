#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "core/formats/load_scene.h"
#include "core/io/file_io.h"

namespace sightline::fuzz {

/// Ends the process, which the fuzzer counts as a finding, unless `condition` holds.
void require(bool condition, const std::string& what);

/// A copy of the very size, so that a read past its end is seen.
FileBytes fileBytes(const uint8_t* data, size_t size);

/// Calls `read`. An Error must be a line without control characters that begins with `name`; anything else
/// that is thrown ends the process.
void expectLine(const std::string& name, const std::function<void()>& read);

/// Loads the bytes, under a name with that extension, as they are and with repair. A scene must keep what
/// core/scene/scene.h promises and come back from OBJ and GLB bit for bit, if it has no offset; repair must
/// take what is taken without, and give the same.
void checkScene(const std::string& extension, const uint8_t* data, size_t size);

}  // namespace sightline::fuzz
