#pragma once
#include <span>
#include <string>

namespace sightline {

/// The command that started this program, as a shell takes it: "sightline bake 'my city.glb' ...". Without
/// the folder of the program.
std::string commandLine();

/// The words as a shell takes them: those with other than plain characters in single quotes.
std::string shellQuoted(std::span<const std::string> words);

}  // namespace sightline
