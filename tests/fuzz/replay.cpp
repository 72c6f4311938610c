// Runs a fuzz target over the files of folders without libFuzzer, so that every test run tries the seeds and
// the findings of old.
#include <cstdio>
#include <filesystem>

#include "core/io/file_io.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

int main(int argc, char** argv) {
  size_t files = 0;
  for (int i = 1; i < argc; ++i) {
    for (const auto& entry : std::filesystem::directory_iterator(argv[i])) {
      std::printf("%s\n", entry.path().c_str());
      std::fflush(stdout);  // a failure ends the process: the last line says at which file
      const sightline::FileBytes bytes = sightline::readFile(entry.path());
      LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(bytes.data.get()), bytes.size);
      ++files;
    }
  }
  return files == 0 ? 1 : 0;
}
