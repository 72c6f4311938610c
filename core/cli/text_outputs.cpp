#include "core/cli/text_outputs.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "core/base/error.h"
#include "core/io/file_io.h"

namespace sightline {
namespace {

[[noreturn]] void fail() {
  throw Error(fmt::format("cannot write to standard output: {}", std::strerror(errno)));
}

}  // namespace

bool isStandardOutput(const std::filesystem::path& file) {
  return file == "-";
}

TextOutputs::TextOutputs(std::span<const std::filesystem::path> files) {
  for (const std::filesystem::path& file : files) {
    if (!file.empty() && !isStandardOutput(file)) OutputFile probe(file);
  }
  if (std::none_of(files.begin(), files.end(), isStandardOutput)) return;
  std::fflush(stdout);
  output_ = ::dup(STDOUT_FILENO);
  if (output_ < 0 || ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0) fail();
}

TextOutputs::~TextOutputs() {
  if (output_ < 0) return;
  std::fflush(stdout);
  ::dup2(output_, STDOUT_FILENO);
  ::close(output_);
}

void TextOutputs::save(std::string_view text, const std::filesystem::path& file) const {
  if (file.empty()) return;
  if (isStandardOutput(file)) {
    write(text);
  } else {
    saveText(text, file);
  }
}

void TextOutputs::write(std::string_view text) const {
  while (!text.empty()) {
    const ssize_t written = ::write(output_, text.data(), text.size());
    if (written < 0 && errno == EPIPE) return;
    if (written < 0 && errno != EINTR) fail();
    text.remove_prefix(size_t(std::max<ssize_t>(written, 0)));
  }
}

}  // namespace sightline
