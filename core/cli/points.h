#pragma once
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace sightline {

/// Finite numbers with commas between them. where: what the error's line begins with. Throws Error (exit code
/// 2).
std::vector<double> parseNumbers(const std::string& text, const std::string& where);

/// Of x,y,z.
glm::dvec3 parsePoint(const std::string& text, const std::string& where);

/// Points from the words of an option; one that names a file stands for the points in it, x,y,z on each line,
/// # starts a comment.
std::vector<glm::dvec3> readPoints(const std::vector<std::string>& words, const std::string& option);

}  // namespace sightline
