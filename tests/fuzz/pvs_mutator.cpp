// Changes .pvs files for libFuzzer: mostly within a section, whose size and checksum then still fit.
#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "core/pvs/pvs_sections.h"

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size);

namespace sightline::fuzz {
namespace {

template <typename T>
T numberAt(const uint8_t* data) {
  T value;
  std::memcpy(&value, data, sizeof value);
  return value;
}

/// A section as docs/pvs-format.md has it, checksum and all.
struct Place {
  size_t at = 0;
  size_t payload = 0;
  size_t end() const { return at + kSectionHeadBytes + payload + kSectionChecksumBytes; }
};

/// The sections of a file, up to the first that is cut off.
std::vector<Place> sectionsOf(const uint8_t* data, size_t size) {
  std::vector<Place> places;
  for (size_t at = kPvsPreludeBytes; at < size && size - at >= kSectionHeadBytes + kSectionChecksumBytes;) {
    const auto payload = numberAt<uint64_t>(data + at + 8);
    if (payload > size - at - kSectionHeadBytes - kSectionChecksumBytes) break;
    places.push_back({at, size_t(payload)});
    at = places.back().end();
  }
  return places;
}

/// Puts the checksums right as far as there are sections, else changes would never reach what is behind them.
void mendChecksums(uint8_t* data, size_t size) {
  for (const Place& section : sectionsOf(data, size)) {
    uint8_t* payload = data + section.at + kSectionHeadBytes;
    if (numberAt<uint32_t>(data + section.at) == kSectionEnd && section.payload == 16) {
      const uint64_t all = XXH3_64bits(data, section.at);
      std::memcpy(payload + 8, &all, sizeof all);
    }
    const uint64_t checksum = XXH3_64bits(data + section.at, kSectionHeadBytes + section.payload);
    std::memcpy(payload + section.payload, &checksum, sizeof checksum);
  }
}

/// Changes the payload of one section, and its size with it; returns the file's size.
size_t mutateSection(uint8_t* data, size_t size, size_t max_size, const Place& section) {
  const Bytes rest(data + section.at + kSectionHeadBytes + section.payload, data + size);
  uint8_t* payload = data + section.at + kSectionHeadBytes;
  const uint64_t mutated = LLVMFuzzerMutate(payload, section.payload, section.payload + (max_size - size));
  std::memcpy(data + section.at + 8, &mutated, sizeof mutated);
  std::copy(rest.begin(), rest.end(), payload + mutated);
  return size - section.payload + size_t(mutated);
}

}  // namespace
}  // namespace sightline::fuzz

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size, unsigned int seed) {
  using namespace sightline::fuzz;
  std::minstd_rand random(seed);
  const std::vector<Place> sections = sectionsOf(data, size);
  // A section needs room to grow: libFuzzer must not be asked for nothing in no room.
  const bool anywhere = sections.empty() || size >= max_size || random() % 4 == 0;
  size = anywhere ? LLVMFuzzerMutate(data, size, max_size)
                  : mutateSection(data, size, max_size, sections[random() % sections.size()]);
  constexpr unsigned kLeftWrong = 16;  // one of so many keeps its wrong checksums
  if (random() % kLeftWrong != 0) mendChecksums(data, size);
  return size;
}
