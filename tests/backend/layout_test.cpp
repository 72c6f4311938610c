// Every struct in a buffer as a kernel and a shader write it: each field lies where C++ has it.
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#define CL_HPP_TARGET_OPENCL_VERSION 120
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <CL/opencl.hpp>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "bvh/bvh.h"
#include "core/device/vulkan/tracing_needs.h"
#include "core/device/vulkan/vulkan_runner.h"
#include "core/shared/border.h"
#include "core/shared/reverse.h"
#include "core/shared/view_ray.h"
#include "core/trace/trace_layout.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/vulkan.h"

namespace sightline {
namespace {

struct Field {
  std::string name, type;  ///< type: vec4, uvec4, uint64, float, uint or a buffer's of vk_shaders/state.glsl
  size_t offset;           ///< in C++
  bool isAddress() const { return type.starts_with("Buffer_"); }
  uint32_t words() const { return type == "uint64" || isAddress() ? 2 : type.ends_with("vec4") ? 4 : 1; }
};

struct Layout {
  std::string name;
  size_t bytes;
  std::vector<Field> fields;
};

#define SL_FIELD(type, field)            \
  Field {                                \
#field, type, offsetof(SL_OF, field) \
  }

/// The numbers of a launch, in all three languages, as part of `prefix`.
std::vector<Field> launchFields(const std::string& prefix) {
#define SL_OF StageLaunch
  std::vector<Field> fields = {SL_FIELD("uvec4", params.counts),   SL_FIELD("uvec4", params.shifts),
                               SL_FIELD("vec4", params.distances), SL_FIELD("uvec4", params.method),
                               SL_FIELD("vec4", params.spacing),   SL_FIELD("vec4", params.look),
                               SL_FIELD("uvec4", segment.range),   SL_FIELD("uvec4", segment.batch),
                               SL_FIELD("uvec4", segment.digits),  SL_FIELD("uvec4", segment.coefficients),
                               SL_FIELD("uvec4", shifts),          SL_FIELD("uint64", items_before),
                               SL_FIELD("uint", capacity),         SL_FIELD("uint", border_first),
                               SL_FIELD("uint", border_count),     SL_FIELD("uint", waiting),
                               SL_FIELD("uint", reverse_first),    SL_FIELD("uint", stage),
                               SL_FIELD("uint", segment_count),    SL_FIELD("uint", list_end),
                               SL_FIELD("uint", word_count),       SL_FIELD("uint", block_count),
                               SL_FIELD("uint", sum_place),        SL_FIELD("uint", level),
                               SL_FIELD("uint", resolution),       SL_FIELD("uint", item_count)};
#undef SL_OF
  for (Field& field : fields) field.name = prefix + field.name;
  return fields;
}

/// The structs of all three languages.
std::vector<Layout> sharedLayouts() {
  std::vector<Layout> all;
#define SL_OF Ray
  all.push_back({"Ray", sizeof(Ray), {SL_FIELD("vec4", origin), SL_FIELD("vec4", direction)}});
#undef SL_OF
#define SL_OF Hit
  all.push_back({"Hit", sizeof(Hit), {SL_FIELD("float", t), SL_FIELD("uint", triangle)}});
#undef SL_OF
#define SL_OF Face
  all.push_back({"Face",
                 sizeof(Face),
                 {SL_FIELD("vec4", corner), SL_FIELD("vec4", edge_u), SL_FIELD("vec4", edge_v),
                  SL_FIELD("vec4", axis_u), SL_FIELD("vec4", axis_v), SL_FIELD("vec4", normal)}});
#undef SL_OF
#define SL_OF PvsEntry
  all.push_back({"PvsEntry",
                 sizeof(PvsEntry),
                 {SL_FIELD("uvec4", origin_triangle), SL_FIELD("uvec4", direction_stage)}});
#undef SL_OF
#define SL_OF StageParams
  all.push_back({"StageParams",
                 sizeof(StageParams),
                 {SL_FIELD("uvec4", counts), SL_FIELD("uvec4", shifts), SL_FIELD("vec4", distances),
                  SL_FIELD("uvec4", method), SL_FIELD("vec4", spacing), SL_FIELD("vec4", look)}});
#undef SL_OF
#define SL_OF RandomSegment
  all.push_back({"RandomSegment",
                 sizeof(RandomSegment),
                 {SL_FIELD("uvec4", range), SL_FIELD("uvec4", batch), SL_FIELD("uvec4", digits),
                  SL_FIELD("uvec4", coefficients)}});
#undef SL_OF
#define SL_OF ViewFrame
  all.push_back(
      {"ViewFrame",
       sizeof(ViewFrame),
       {SL_FIELD("vec4", origin), SL_FIELD("vec4", forward), SL_FIELD("vec4", right), SL_FIELD("vec4", up)}});
#undef SL_OF
#define SL_OF BorderEdge
  all.push_back({"BorderEdge",
                 sizeof(BorderEdge),
                 {SL_FIELD("vec4", bisector), SL_FIELD("vec4", start), SL_FIELD("vec4", end)}});
#undef SL_OF
#define SL_OF Discontinuity
  all.push_back({"Discontinuity", sizeof(Discontinuity), {SL_FIELD("uvec4", ray)}});
#undef SL_OF
#define SL_OF ReverseItem
  all.push_back({"ReverseItem",
                 sizeof(ReverseItem),
                 {SL_FIELD("vec4", target), SL_FIELD("vec4", a), SL_FIELD("vec4", b), SL_FIELD("vec4", c),
                  SL_FIELD("uvec4", number)}});
#undef SL_OF
#define SL_OF BvhNode2
  Layout node{"BvhNode2", sizeof(BvhNode2), {SL_FIELD("vec4", x), SL_FIELD("vec4", y), SL_FIELD("vec4", z)}};
#undef SL_OF
  for (size_t i = 0; i < 2; ++i) {
    node.fields.push_back({fmt::format("child[{}]", i), "uint", offsetof(BvhNode2, child) + 4 * i});
  }
  for (size_t i = 0; i < 2; ++i) {
    node.fields.push_back({fmt::format("count[{}]", i), "uint", offsetof(BvhNode2, count) + 4 * i});
  }
  all.push_back(node);
  Layout record{"TriangleRecord", sizeof(TriangleRecord), {}};
  for (size_t i = 0; i < 9; ++i) {
    record.fields.push_back(
        {fmt::format("vertices[{}]", i), "float", offsetof(TriangleRecord, vertices) + 4 * i});
  }
  record.fields.push_back({"id", "uint", offsetof(TriangleRecord, id)});
  all.push_back(record);
#define SL_OF TriangleRecordGpu
  all.push_back({"TriangleRecordGpu",
                 sizeof(TriangleRecordGpu),
                 {SL_FIELD("vec4", v0), SL_FIELD("vec4", v1), SL_FIELD("vec4", v2)}});
#undef SL_OF
#define SL_OF InstanceRecord
  all.push_back({"InstanceRecord",
                 sizeof(InstanceRecord),
                 {SL_FIELD("vec4", place.x), SL_FIELD("vec4", place.y), SL_FIELD("vec4", place.z),
                  SL_FIELD("vec4", place.origin), SL_FIELD("vec4", local_x), SL_FIELD("vec4", local_y),
                  SL_FIELD("vec4", local_z), SL_FIELD("vec4", padding), SL_FIELD("uvec4", ids),
                  SL_FIELD("uvec4", roots)}});
#undef SL_OF
  all.push_back({"StageLaunch", sizeof(StageLaunch), launchFields("")});
  return all;
}

/// What the host tells every Vulkan shader.
Layout vulkanLayout() {
  Layout launch{"VulkanLaunch", sizeof(VulkanLaunch), launchFields("numbers.")};
#define SL_BUFFER_FIELD(type, name) \
  launch.fields.push_back(          \
      {#name, "Buffer_" #type, offsetof(VulkanLaunch, addresses) + 8 * uint32_t(StageBuffer::name)});
  SL_STAGE_BUFFERS(SL_BUFFER_FIELD)
#undef SL_BUFFER_FIELD
#define SL_OF VulkanLaunch
#define SL_ADDRESS(field) launch.fields.push_back(SL_FIELD("uint64", field))
  SL_ADDRESS(tlas), SL_ADDRESS(part_starts), SL_ADDRESS(part_ids), SL_ADDRESS(part_places),
      SL_ADDRESS(instances), SL_ADDRESS(leaf_ids);
  SL_ADDRESS(corners), SL_ADDRESS(surfaces), SL_ADDRESS(hemicube), SL_ADDRESS(hemicubes),
      SL_ADDRESS(chunk_bounds), SL_ADDRESS(draws), SL_ADDRESS(raster_leaves);
#undef SL_ADDRESS
#define SL_WORD(field) launch.fields.push_back(SL_FIELD("uint", field))
  SL_WORD(raster_resolution), SL_WORD(raster_first), SL_WORD(chunk_count), SL_WORD(triangle_count);
  SL_WORD(instance_count);
  launch.fields.push_back(SL_FIELD("float", raster_near));
#undef SL_WORD
#undef SL_OF
  return launch;
}

/// Elements of an array that a struct is written to, and what word `word` of element `element` gets: as a
/// float an ordinary number.
constexpr uint32_t kElements = 3;
constexpr uint32_t kFirstValue = 0x40000000u, kNextElement = 1000;

/// Statements that give every word of the struct `s` of element `i` its value.
std::string assignments(const Layout& layout, bool opencl) {
  std::string text;
  uint32_t word = 0;
  for (const Field& field : layout.fields) {
    std::string values;
    for (uint32_t w = 0; w < field.words(); ++w) {
      values += fmt::format("{}{}u + {}u * i", w > 0 ? ", " : "", kFirstValue + word++, kNextElement);
    }
    if (field.words() == 2) {
      values = opencl ? fmt::format("as_ulong((uint2)({}))", values)
                      : fmt::format("{}(packUint2x32(uvec2({})))",
                                    field.isAddress() ? field.type : "uint64_t", values);
    } else if (field.type.ends_with("vec4")) {
      values = fmt::format("{}({})", opencl ? "(uint4)" : "uvec4", values);
    }
    if (field.type == "vec4")
      values = fmt::format("{}({})", opencl ? "as_float4" : "uintBitsToFloat", values);
    if (field.type == "float")
      values = fmt::format("{}({})", opencl ? "as_float" : "uintBitsToFloat", values);
    text += fmt::format("  s.{} = {};\n", field.name, values);
  }
  return text;
}

void expectWritten(const std::vector<uint32_t>& words, const Layout& layout) {
  for (uint32_t i = 0; i < kElements; ++i) {
    uint32_t word = 0;
    for (const Field& field : layout.fields) {
      for (uint32_t w = 0; w < field.words(); ++w) {
        const size_t place = (i * layout.bytes + field.offset) / 4 + w;
        EXPECT_EQ(words.at(place), kFirstValue + word++ + kNextElement * i)
            << layout.name << "." << field.name << ", word " << w << " of element " << i;
      }
    }
    EXPECT_EQ(word * 4, layout.bytes) << layout.name << " has fields that are not in this test, or padding";
  }
}

/// Headers that the structs come from.
const char* const kIncludes =
    "#include \"core/shared/border.h\"\n#include \"core/shared/bvh_node.h\"\n#include "
    "\"core/shared/placement.h\"\n#include \"core/shared/reverse.h\"\n"
    "#include \"core/shared/stage_launch.h\"\n#include \"core/shared/view_ray.h\"\n";

TEST(OpenClLayout, KernelsWriteFieldsWhereCppHasThem) {
  const std::vector<Layout> layouts = sharedLayouts();
  std::string source = kIncludes;
  for (const Layout& layout : layouts) {
    source += fmt::format(
        "__kernel void write{0}(__global {0}* out) {{\n  uint i = (uint)get_global_id(0);\n  {0} s;\n{1}"
        "  out[i] = s;\n}}\n",
        layout.name, assignments(layout, true));
  }
  std::vector<cl::Platform> platforms;
  std::vector<cl::Device> devices;
  ASSERT_EQ(cl::Platform::get(&platforms), CL_SUCCESS) << "pocl-opencl-icd is needed";
  ASSERT_EQ(platforms.front().getDevices(CL_DEVICE_TYPE_ALL, &devices), CL_SUCCESS);
  const cl::Context context(devices.front());
  cl::CommandQueue queue(context, devices.front());
  cl::Program program(context, source);
  std::filesystem::current_path(SL_SOURCE_DIR);  // build options cannot quote a folder whose name has blanks
  ASSERT_EQ(program.build(devices.front(), "-cl-std=CL1.2 -I."), CL_SUCCESS)
      << program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(devices.front());
  for (const Layout& layout : layouts) {
    std::vector<uint32_t> words(kElements * layout.bytes / 4);
    const cl::Buffer buffer(context, CL_MEM_READ_WRITE, words.size() * 4);
    cl::Kernel kernel(program, ("write" + layout.name).c_str());
    ASSERT_EQ(kernel.setArg(0, buffer), CL_SUCCESS);
    ASSERT_EQ(queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(kElements)), CL_SUCCESS);
    ASSERT_EQ(queue.enqueueReadBuffer(buffer, CL_TRUE, 0, words.size() * 4, words.data()), CL_SUCCESS);
    expectWritten(words, layout);
  }
}

/// Runs a shader over lists (vk_shaders/list.glsl) that writes to launch.rays.
std::vector<uint32_t> runShader(const VulkanContext& context, const std::vector<uint32_t>& code,
                                size_t bytes) {
  const VulkanApi& api = context.api();
  auto module_info = vkStruct<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
  module_info.codeSize = code.size() * 4;
  module_info.pCode = code.data();
  VkShaderModule made = VK_NULL_HANDLE;
  checkVk(api.vkCreateShaderModule(context.device(), &module_info, nullptr, &made), "vkCreateShaderModule");
  const VulkanHandle<VkShaderModule> module(context, made, [](const VulkanContext& c, VkShaderModule handle) {
    c.api().vkDestroyShaderModule(c.device(), handle, nullptr);
  });
  const VulkanHandle<VkPipelineLayout> layout = pushLayout(context, VK_SHADER_STAGE_COMPUTE_BIT);
  auto info = vkStruct<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  info.stage = stageInfo(VK_SHADER_STAGE_COMPUTE_BIT, module.get());
  info.layout = layout.get();
  VkPipeline created = VK_NULL_HANDLE;
  checkVk(api.vkCreateComputePipelines(context.device(), VK_NULL_HANDLE, 1, &info, nullptr, &created),
          "vkCreateComputePipelines");
  const VulkanHandle<VkPipeline> pipeline(context, created, destroyPipeline);

  const VulkanBuffer output = context.buffer(bytes, "structs");
  const VulkanBuffer staging = context.buffer(bytes, "structs", VulkanMemory::kReadback);
  VulkanRunner runner(context);
  runner.bind(StageBuffer::rays, output);
  const VulkanPush push{runner.recordLaunch(), 0, kElements};
  const VkCommandBuffer commands = runner.commands.next();
  api.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.get());
  api.vkCmdPushConstants(commands, layout.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
  api.vkCmdDispatch(commands, 1, 1, 1);
  runner.commands.copy(output, staging, bytes);
  runner.commands.finish();
  std::vector<uint32_t> words(bytes / 4);
  std::memcpy(words.data(), staging.mapped(), bytes);
  return words;
}

TEST(VulkanLayout, ShadersWriteFieldsWhereCppHasThem) {
  SL_SKIP_WITHOUT_VULKAN();
  const VulkanContext context("vulkan", tracingNeeds(false));
  const TemporaryFolder folder;
  std::vector<Layout> layouts = sharedLayouts();
  layouts.push_back(vulkanLayout());
  for (const Layout& layout : layouts) {
    const std::string shader = folder / (layout.name + ".comp"), spirv = folder / (layout.name + ".spv");
    std::ofstream(shader) << "#version 460\n#extension GL_GOOGLE_include_directive : require\n"
                          << "#include \"vk_shaders/list.glsl\"\n"
                          << kIncludes
                          << "layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Out {\n  "
                          << layout.name << " at[];\n};\nvoid runItem(uint i) {\n  " << layout.name << " s;\n"
                          << assignments(layout, false)
                          << "  Out(uint64_t(SL_THE_LAUNCH.rays)).at[i] = s;\n}\n";
    const std::string command =
        fmt::format("glslangValidator --quiet -V --target-env vulkan1.2 -S comp -I\"{}\" -o \"{}\" \"{}\"",
                    SL_SOURCE_DIR, spirv, shader);
    ASSERT_EQ(std::system(command.c_str()), 0) << "glslang-tools is needed";
    std::ifstream in(spirv, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), {});
    std::vector<uint32_t> code(bytes.size() / 4);
    std::memcpy(code.data(), bytes.data(), code.size() * 4);
    expectWritten(runShader(context, code, kElements * layout.bytes), layout);
  }
}

}  // namespace
}  // namespace sightline
