# Files that travel inside the library: sl_embed(TARGET HEADER file.h AS kind FILES file... NAMES name...) adds a static
# library that defines what the header declares, built from the files' bytes as they are. By kind:
#   STRING_VIEW   const std::string_view NAME;
#   C_STRING      const char* const NAME;
#   WORDS         std::span<const uint32_t> FUNCTION(std::string_view name), with FUNCTION as the only name: the
#                 little-endian words of the file `name`, its last extension left out; else throws std::out_of_range
# Run as a script (cmake -P), this file writes the library's source.
cmake_minimum_required(VERSION 3.25)

function(sl_embed target)
  cmake_parse_arguments(PARSE_ARGV 1 embed "" "HEADER;AS" "FILES;NAMES")
  set(script ${PROJECT_SOURCE_DIR}/cmake/embed.cmake)
  set(generated ${CMAKE_CURRENT_BINARY_DIR}/${target}.cpp)
  string(REPLACE ";" "|" files "${embed_FILES}")
  string(REPLACE ";" "|" names "${embed_NAMES}")
  add_custom_command(
    OUTPUT ${generated}
    COMMAND ${CMAKE_COMMAND} -DHEADER=${embed_HEADER} -DAS=${embed_AS} "-DFILES=${files}" "-DNAMES=${names}"
            -DOUTPUT=${generated} -P ${script}
    DEPENDS ${embed_FILES} ${script}
    VERBATIM)
  add_library(${target} STATIC ${generated})
  target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR})
  target_compile_features(${target} PUBLIC cxx_std_20)
endfunction()

if(NOT CMAKE_SCRIPT_MODE_FILE)
  return()
endif()
string(REPLACE "|" ";" files "${FILES}")
string(REPLACE "|" ";" names "${NAMES}")
set(byte "([0-9a-f][0-9a-f])")
string(REPEAT "[0-9a-f]" 128 line)
set(arrays "")
set(definitions "")
set(number 0)
foreach(file IN LISTS files)
  file(READ ${file} digits HEX)
  string(REGEX REPLACE "(${line})" "\\1\n" digits "${digits}")
  if(AS STREQUAL "WORDS")
    string(REGEX REPLACE "${byte}${byte}${byte}${byte}" "0x\\4\\3\\2\\1u," elements "${digits}")
    string(APPEND arrays "constexpr uint32_t kFile${number}[] = {\n${elements}};\n")
    get_filename_component(name ${file} NAME_WLE)
    string(APPEND definitions "  if (name == \"${name}\") return kFile${number};\n")
  else()
    string(REGEX REPLACE "${byte}" "'\\\\x\\1'," elements "${digits}")
    string(APPEND arrays "constexpr char kFile${number}[] = {\n${elements}0};\n")
    list(GET names ${number} name)
    if(AS STREQUAL "C_STRING")
      string(APPEND definitions "const char* const ${name} = kFile${number};\n")
    else()
      string(APPEND definitions "const std::string_view ${name}(kFile${number}, sizeof(kFile${number}) - 1);\n")
    endif()
  endif()
  math(EXPR number "${number} + 1")
endforeach()
if(AS STREQUAL "WORDS")
  set(definitions "std::span<const uint32_t> ${NAMES}(std::string_view name) {\n${definitions}\
  throw std::out_of_range(\"no file \" + std::string(name));\n}\n")
endif()
file(WRITE ${OUTPUT} "#include \"${HEADER}\"\n#include <stdexcept>\n#include <string>\n\
namespace sightline {\nnamespace {\n${arrays}}\n${definitions}}\n")
