// Build tool: embed_spirv OUTPUT.cpp FILE.spv... writes a C++ file that defines shaderCode (shaders.h). A
// shader's name is its file's name without ".spv".
//
// On the way it decorates every float operation NoContraction. GLSL's `precise` does not reach into called
// functions, and the shared headers consist of functions.
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

void writeArray(std::ofstream& out, const std::string& name, const Words& words) {
  out << "constexpr uint32_t " << name << "[] = {";
  for (size_t i = 0; i < words.size(); ++i) out << (i % 16 == 0 ? "\n" : "") << words[i] << "u,";
  out << "};\n";
}

void embed(const std::filesystem::path& output, const std::vector<std::filesystem::path>& files) {
  std::ofstream out(output);
  out << "#include \"vk_shaders/shaders.h\"\n#include <stdexcept>\n#include <string>\n"
         "namespace sightline {\nnamespace {\n";
  std::string choices;
  for (size_t i = 0; i < files.size(); ++i) {
    const std::string array = "kShader" + std::to_string(i);
    writeArray(out, array, withoutContraction(readSpirv(files[i])));
    choices += "  if (name == \"" + files[i].stem().string() + "\") return " + array + ";\n";
  }
  out << "}\nstd::span<const uint32_t> shaderCode(std::string_view name) {\n"
      << choices << "  throw std::out_of_range(\"no shader \" + std::string(name));\n}\n}\n";
  if (!out.flush()) throw std::runtime_error("cannot write " + output.string());
}

}  // namespace

int main(int count, char** arguments) try {
  if (count < 3) throw std::runtime_error("usage: embed_spirv OUTPUT.cpp FILE.spv...");
  embed(arguments[1], {arguments + 2, arguments + count});
} catch (const std::exception& error) {
  std::fprintf(stderr, "embed_spirv: %s\n", error.what());
  return 1;
}
