#include "core/io/csv.h"

#include <stdexcept>

namespace sightline {
namespace {

std::string field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

}  // namespace

Csv::Csv(const std::vector<std::string>& columns) : columns_(columns.size()) {
  line(columns);
}

void Csv::row(const std::vector<std::string>& fields) {
  if (fields.size() != columns_) throw std::invalid_argument("a row of another length than the columns");
  line(fields);
}

void Csv::line(const std::vector<std::string>& fields) {
  for (size_t i = 0; i < fields.size(); ++i) {
    if (i > 0) text_ += ',';
    text_ += field(fields[i]);
  }
  text_ += "\n";
}

}  // namespace sightline
