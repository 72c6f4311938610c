// Build tool: no_contraction FOLDER FILE.spv... writes each module into the folder with every float operation
// decorated NoContraction. GLSL's `precise` does not reach into called functions, and the shared headers
// consist of functions.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Words = std::vector<uint32_t>;

// Numbers of the SPIR-V specification, version 1.5.
constexpr uint32_t kMagic = 0x07230203;
constexpr size_t kHeaderWords = 5;
constexpr uint32_t kOpDecorate = 71, kDecorationNoContraction = 42;
constexpr uint32_t kFirstType = 19, kLastConstant = 52;  // OpTypeVoid .. OpSpecConstantOp

/// Arithmetic instructions on floats; the result's id is the second operand.
bool isFloatOperation(uint32_t op) {
  switch (op) {
    case 127:  // OpFNegate
    case 129:  // OpFAdd
    case 131:  // OpFSub
    case 133:  // OpFMul
    case 136:  // OpFDiv
    case 140:  // OpFRem
    case 141:  // OpFMod
    case 142:  // OpVectorTimesScalar
    case 143:  // OpMatrixTimesScalar
    case 144:  // OpVectorTimesMatrix
    case 145:  // OpMatrixTimesVector
    case 146:  // OpMatrixTimesMatrix
    case 148:  // OpDot
      return true;
    default:
      return false;
  }
}

Words readSpirv(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  Words words(bytes.size() / 4);
  std::copy(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(words.size() * 4),
            reinterpret_cast<char*>(words.data()));
  if (words.size() <= kHeaderWords || words[0] != kMagic) {
    throw std::runtime_error(file.string() + ": not a SPIR-V file");
  }
  return words;
}

/// The module with its float operations decorated. Decorations stand before the first type.
Words withoutContraction(const Words& module) {
  Words decorations;
  size_t first_type = 0;
  for (size_t i = kHeaderWords; i < module.size(); i += module[i] >> 16) {
    const uint32_t op = module[i] & 0xffff;
    if ((module[i] >> 16) == 0) throw std::runtime_error("instruction of zero words");
    if (first_type == 0 && op >= kFirstType && op <= kLastConstant) first_type = i;
    if (isFloatOperation(op)) {
      decorations.insert(decorations.end(),
                         {3u << 16 | kOpDecorate, module[i + 2], kDecorationNoContraction});
    }
  }
  Words result(module);
  result.insert(result.begin() + static_cast<std::ptrdiff_t>(first_type), decorations.begin(),
                decorations.end());
  return result;
}

void writeSpirv(const std::filesystem::path& file, const Words& words) {
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(words.data()), std::streamsize(words.size() * sizeof(uint32_t)));
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
}

}  // namespace

int main(int count, char** arguments) try {
  if (count < 3) throw std::runtime_error("usage: no_contraction FOLDER FILE.spv...");
  const std::filesystem::path folder = arguments[1];
  std::filesystem::create_directories(folder);
  for (int i = 2; i < count; ++i) {
    const std::filesystem::path file = arguments[i];
    writeSpirv(folder / file.filename(), withoutContraction(readSpirv(file)));
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "no_contraction: %s\n", error.what());
  return 1;
}
