#pragma once
#include <string>
#include <vector>

namespace sightline {

/// Lines of comma-separated values (RFC 4180), each ended by a newline alone: a field with a comma, a quote
/// or a line break stands in quotes.
class Csv {
 public:
  explicit Csv(const std::vector<std::string>& columns);
  /// Throws std::invalid_argument unless it is as long as the columns.
  void row(const std::vector<std::string>& fields);
  const std::string& text() const { return text_; }

 private:
  void line(const std::vector<std::string>& fields);

  size_t columns_;
  std::string text_;
};

}  // namespace sightline
